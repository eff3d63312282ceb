#include <string>

#include <gmock/gmock.h>

#include "wellgyro/io/exchange/exchange.h"

#include "io/exchange/parsed.h"
#include "support/survey_samples.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

std::string Trajectory(const std::string& inside) {
  return "<?xml version=\"1.0\"?>\n<trajectorys xmlns=\"http://www.witsml.org/schemas/1series\">\n"
         "<trajectory uid=\"t\">\n<aziRef>true north</aziRef>\n" +
         inside + "</trajectory>\n</trajectorys>\n";
}

std::string Station(const std::string& md, const std::string& more = "") {
  return "<trajectoryStation uid=\"s\">\n<md uom=\"ft\" datum=\"KB\">" + md +
         "</md>\n<incl uom=\"dega\">1.5</incl><azi uom=\"rad\">0.5</azi>" + more +
         "</trajectoryStation>\n";
}

TEST(Witsml, UnitsAreEachElementsOwn) {
  const auto t = ParseSurvey(
      Trajectory(Station("100", "<dispNs uom=\"m\">2</dispNs><dls uom=\"dega/100ft\">3</dls>")),
      "text");
  ASSERT_TRUE(t) << t.fault().text;
  EXPECT_EQ(t->md(0), 100 * units::kFoot);
  EXPECT_EQ(t->azimuth(0), 0.5);
  EXPECT_EQ(t->Get(Column::kNorth, 0), 2);
  EXPECT_EQ(t->Get(Column::kDogleg, 0), 3 * units::kDegPer100ft);
  EXPECT_EQ(t->head.datum, "KB");
}

TEST(Witsml, SeveralTrajectoriesAndStationsWithoutAzimuth) {
  const auto one = [](const std::string& name) {
    return "<trajectory uid=\"u-" + name + "\"><name>" + name +
           "</name><aziRef>true north</aziRef>" + Station("0") +
           "<trajectoryStation><md uom=\"ft\">50</md><incl uom=\"dega\">2</incl>"
           "</trajectoryStation>" +
           Station("100") + "</trajectory>";
  };
  const std::string text = "<trajectorys>" + one("A") + one("B") + "</trajectorys>";
  EXPECT_THAT(ParseFault(text).text, HasSubstr("A, B; say which by --trajectory"));
  const auto t = ParseSurvey(text, "text", {.trajectory = "u-B"});
  ASSERT_TRUE(t) << t.fault().text;
  EXPECT_EQ(t->head.names.survey, "B");
  EXPECT_EQ(t->status(1), RowStatus::kAzimuthInterpolated);
  EXPECT_NEAR(t->azimuth(1), 0.5, 1e-12);
}

TEST(Witsml, Version2WithPrefixesAndSigma) {
  const std::string text =
      "<w:Trajectory xmlns:w=\"w\" xmlns:eml=\"e\" schemaVersion=\"2.1\" uuid=\"u\">"
      "<eml:Citation><eml:Title>Run 1</eml:Title></eml:Citation>"
      "<w:TrajectoryStation uid=\"1\"><eml:Md><eml:MeasuredDepth "
      "uom=\"ft[US]\">10</eml:MeasuredDepth>"
      "</eml:Md><w:TypeTrajStation>tie in point</w:TypeTrajStation>"
      "<w:Tvd><eml:VerticalDepth uom=\"m\">3</eml:VerticalDepth></w:Tvd>"
      "<w:Incl uom=\"dega\">2</w:Incl><w:Azi uom=\"dega\">-320</w:Azi>"
      "<w:Dls uom=\"0.01 dega/ft\">3</w:Dls>"
      "<w:MatrixCov><w:VarianceNN uom=\"m2\">8</w:VarianceNN><w:Sigma>2</w:Sigma></w:MatrixCov>"
      "</w:TrajectoryStation><w:AziRef>grid north</w:AziRef></w:Trajectory>";
  const auto t = ParseSurvey(text, "text");
  ASSERT_TRUE(t) << t.fault().text;
  EXPECT_EQ(t->head.names.survey, "Run 1");
  EXPECT_EQ(t->md(0), 10 * units::kUsSurveyFoot);
  EXPECT_EQ(t->Get(Column::kTvd, 0), 3);
  EXPECT_NEAR(t->azimuth(0), 40 * units::kDeg, 1e-15);
  EXPECT_EQ(t->Get(Column::kDogleg, 0), 3 * units::kDegPer100ft);
  EXPECT_EQ(t->Get(Column::kVarNN, 0), 2);
  EXPECT_EQ(t->status(0), RowStatus::kTieIn);
}

TEST(Witsml, FaultsNameTheElementAndItsLine) {
  const Fault number = ParseFault(Trajectory(Station("1") + Station("x")));
  EXPECT_THAT(number.text, HasSubstr("/trajectorys/trajectory/trajectoryStation[2]/md: 'x'"));
  EXPECT_EQ(number.line, 9);
  EXPECT_EQ(ParseFault(Trajectory(Station("1") + Station("3") + Station("2"))).code,
            FaultCode::kOrder);
  EXPECT_THAT(ParseFault(Trajectory(Station("1", "<tvd uom=\"parsec\">1</tvd>"))).text,
              HasSubstr("parsec"));
  EXPECT_THAT(ParseFault(Trajectory("<trajectoryStation uid=\"s\"><md uom=\"m\">1</md>"
                                    "</trajectoryStation>"))
                  .text,
              HasSubstr("no incl"));
  EXPECT_THAT(ParseFault(Trajectory("")).text, HasSubstr("station"));
  EXPECT_THAT(ParseFault("<logs/>").text, HasSubstr("no WITSML trajectory"));
  EXPECT_EQ(ParseFault("<a>\n<b>\n</a>").line, 3);
}

TEST(Witsml, NoEntitiesNoDepthsWithoutEnd) {
  const std::string bomb =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE t [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]>\n<t/>";
  EXPECT_THAT(ParseFault(bomb).text, HasSubstr("document type"));
  EXPECT_EQ(ParseFault(bomb).line, 2);
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  EXPECT_THAT(ParseFault(deep).text, HasSubstr("deep"));
  // '>' in a value and in comments is no end.
  const auto t = ParseSurvey(
      Trajectory("<!-- <<< > --><x a=\"1>2\" b='</a>'/>" + Station("1") + "<![CDATA[<<<]]>"), "t");
  EXPECT_TRUE(t) << t.fault().text;
}

TEST(Witsml, Utf16IsRead) {
  SurveyTable table = support::FullSurvey();
  table.head.names.well = "A \xF0\x9F\x9B\xA2 \xC3\xA6";  // beyond the first plane of Unicode
  const std::string text = WriteSurvey(table, SurveyFormat::kWitsml1411);
  std::u16string wide;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 4, "\xF0\x9F\x9B\xA2") == 0) {
      wide += u"\xD83D\xDEE2", i += 3;
    } else if (text[i] == '\xC3') {
      wide += static_cast<char16_t>(0xC0 | (text[++i] & 0x3F));
    } else {
      wide += static_cast<char16_t>(static_cast<unsigned char>(text[i]));
    }
  }
  for (const bool little : {true, false}) {
    std::string bytes = little ? "\xFF\xFE" : "\xFE\xFF";
    for (const char16_t unit : wide) {
      const char low = static_cast<char>(unit & 0xFF), high = static_cast<char>(unit >> 8);
      bytes += little ? low : high;
      bytes += little ? high : low;
    }
    const auto back = ParseSurvey(bytes, "text");
    ASSERT_TRUE(back) << back.fault().text;
    EXPECT_EQ(back->head.names.well, table.head.names.well);
    EXPECT_EQ(back->rows(), table.rows());
  }
}

TEST(Witsml, NamesInLatin1) {
  const std::string text =
      "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><trajectorys><trajectory>"
      "<nameWell>\xC6\x6B</nameWell>" +
      Station("1") + "</trajectory></trajectorys>";
  const auto t = ParseSurvey(text, "text");
  ASSERT_TRUE(t) << t.fault().text;
  EXPECT_EQ(t->head.names.well, "\xC3\x86k");
}

TEST(Witsml, TimesAreInstants) {
  const auto at = [](const std::string& time) {
    const auto t = ParseSurvey(Trajectory(Station("1", "<dTimStn>" + time + "</dTimStn>")), "text");
    return t ? t->Get(Column::kUtc, 0) : std::nullopt;
  };
  EXPECT_EQ(at("1970-01-01T00:00:00Z"), 0);
  EXPECT_EQ(at("2026-01-15T06:12:00.500Z"), 1768457520.5);
  EXPECT_EQ(at("2026-01-15T07:12:00.500+01:00"), 1768457520.5);
  EXPECT_EQ(at("2000-02-29T23:59:59Z"), 951868799);
  EXPECT_FALSE(at("2026-01-15T06:12:00"));  // no zone: no instant
  EXPECT_FALSE(at("yesterday"));
}

}  // namespace
}  // namespace wellgyro
