// Files as other programs lay them out: LAS 3.0, Petra's keywords, Landmark's well plans,
// workbooks.
#include <map>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <zip.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/exchange.h"

#include "io/exchange/parsed.h"

namespace wellgyro {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr char kLas3Head[] =
    "~Version\n VERS. 3.0 : CWLS\n WRAP. NO :\n DLM. COMMA : \n~Well\n STRT.M 1000 :\n"
    " STOP.M 1001 :\n STEP.M 0.5 :\n NULL. -999.25 :\n WELL. A-1 : WELL\n";
constexpr char kLas3Log[] =
    "~Log_Parameter\n TEMP.DEGC 20 : {F}\n~Log_Definition\n DEPT.M : depth {F}\n"
    " GR.GAPI : gamma {F}\n~Log_Data | Log_Definition\n1000,50\n1000.5,51\n1001,49\n";
constexpr char kLas3Survey[] =
    "~Inclinometry_Parameter\n I_AT. Grid : azimuths {S}\n I_RF.FT 100 : datum {F}\n"
    "~Inclinometry_Definition\n MD.FT : {F}\n TVD.FT : {F}\n DEVI.DEG : {F}\n AZIM.DEG : {F}\n"
    " NOTE. : {S}\n"
    "~Inclinometry_Data | Inclinometry_Definition\n0,0,0,0,start\n100,99.98,2,90,\n"
    "200,,4,90,end\n";

TEST(Las3, TheSurveyIsTheGroupInclinometry) {
  for (const std::string& text : {std::string(kLas3Head) + kLas3Log + kLas3Survey,
                                  std::string(kLas3Head) + kLas3Survey + kLas3Log}) {
    const SurveyTable t = Parsed(text);
    ASSERT_EQ(t.rows(), 3u);
    EXPECT_EQ(t.md(2), 200 * units::kFoot);
    EXPECT_EQ(t.inclination(1), 2 * units::kDeg);
    EXPECT_EQ(t.Get(Column::kTvd, 1), 99.98 * units::kFoot);
    EXPECT_FALSE(t.Get(Column::kTvd, 2));
    EXPECT_EQ(t.head.azimuth.north, North::kGrid);
    EXPECT_EQ(t.head.names.well, "A-1");
    EXPECT_NEAR(t.head.datum_elevation.value_or(0), 30.48, 1e-12);
    EXPECT_THAT(t.head.notes, Contains(HasSubstr("a cut could not be seen")));
  }
  EXPECT_THAT(ParseFault(std::string(kLas3Head) + kLas3Log).text, HasSubstr("~Inclinometry_Data"));
  EXPECT_THAT(ParseFault(std::string(kLas3Head) + kLas3Survey + kLas3Survey).text,
              HasSubstr("several surveys"));
}

// A survey among the curves of the log, under the names of LAS 2.0.
TEST(Las3, TheLogWhereItHoldsTheSurvey) {
  const SurveyTable t = Parsed(std::string(kLas3Head) +
                               "~Curve\n DEPT.M :\n DEVI.DEG :\n AZIM.DEG :\n~ASCII | Curve\n"
                               "1000,1,20\n1000.5,-999.25,-999.25\n1001,1.5,21\n");
  ASSERT_EQ(t.rows(), 2u);
  EXPECT_EQ(t.md(1), 1001);
}

constexpr char kPetra[] =
    "*WELL 0926421110000100\n*XYUNITS F\n*DEPUNITS F\n*COLUMNS\n*MD\n*INC\n*AZM\n*TVD\n*EW\n"
    "*NS\n0 0 0 0 0 0\n100 2 90 99.98 1.75 0\n200 4 90 199.85 6.98 0\n";

TEST(Petra, KeywordsNameColumnsAndUnits) {
  const SurveyTable t = Parsed(kPetra);
  ASSERT_EQ(t.rows(), 3u);
  EXPECT_EQ(t.md(1), 100 * units::kFoot);
  EXPECT_EQ(t.azimuth(2), 90 * units::kDeg);
  EXPECT_EQ(t.Get(Column::kEast, 2), 6.98 * units::kFoot);
  EXPECT_EQ(t.head.names.well, "0926421110000100");
  // All keywords on one line, and positions without angles, as its manual shows them.
  const SurveyTable positions = Parsed(
      "*WELL 1 *XYUNITS M *DEPUNITS M *COLUMNS *MD *TVD *EW *NS\n0 0 0 0\n100 100 0 0\n"
      "200 186.6 50 0\n");
  ASSERT_EQ(positions.rows(), 3u);
  EXPECT_EQ(positions.status(2), RowStatus::kBackCalculated);
  EXPECT_NEAR(positions.inclination(2), 30 * units::kDeg, 1e-3);
}

TEST(Petra, SeveralWellsAndUnitsThatAreNone) {
  std::string second = kPetra;
  second.replace(second.find("09264"), 5, "11111");
  EXPECT_THAT(ParseFault(kPetra + second).text, HasSubstr("--well"));
  EXPECT_EQ(Parsed(kPetra + second, {.well = "1111121110000100"}).rows(), 3u);
  EXPECT_EQ(Parsed(kPetra + second, {.well = "0926421110000100"}).rows(), 3u);
  EXPECT_EQ(Parsed(kPetra + ("\n" + second), {.well = "1111121110000100"}).rows(), 3u);
  EXPECT_THAT(ParseFault(kPetra + second, {.well = "3"}).text, HasSubstr("no row is of well 3"));
  std::string metric = second;
  metric.replace(metric.find("*DEPUNITS F"), 11, "*DEPUNITS M");
  EXPECT_THAT(ParseFault(kPetra + metric, {.well = "1111121110000100"}).text, HasSubstr("differ"));
  EXPECT_THAT(ParseFault("*WELL 1\n*DEPUNITS yards\n").text, HasSubstr("F nor M"));
}

std::string Plan(const std::string& name) {
  return "W:1200   0 123         " + name + std::string(61 - name.size(), ' ') +
         std::string(60, ' ') +
         "   3.00 0.00000\n"
         "P:    0.00   0.000   0.000   0.000   0.000   0.000   0.000\n"
         "L:    400000.00   6500000.00      25.00\n"
         "P:  100.00  90.000   0.000   0.000   0.000   0.000   0.000    0\n"
         "L:    400000.00   6500000.00     -75.00\n"
         "P:  400.00  90.000  30.000   3.000   0.000   3.000   0.000    0\n"
         "L:    400076.76   6500000.00    -361.48\n";
}

// A build of 30 deg in 300 m has the radius 300 / (pi/6) = 572.96 m: 76.76 m east, 286.48 m down.
TEST(Wbp, PlansOfLandmark) {
  const std::string head = "DEPTH 2\n! a comment\nTARGETS:\nT:one\nL: 1 2 3\nWELLPLANS:\n";
  const SurveyTable t = Parsed(head + Plan("A-1"), {.north = North::kGrid});
  ASSERT_EQ(t.rows(), 3u);
  EXPECT_EQ(t.md(2), 400);
  EXPECT_EQ(t.inclination(2), 30 * units::kDeg);
  EXPECT_EQ(t.Get(Column::kEasting, 2), 400076.76);
  EXPECT_EQ(t.Get(Column::kDown, 2), 361.48);
  EXPECT_EQ(t.head.names.survey, "A-1");
  EXPECT_TRUE(t.head.planned);
  EXPECT_EQ(t.status(1), RowStatus::kPlanned);
  const std::string two = head + Plan("A-1") + Plan("B-2");
  EXPECT_THAT(ParseFault(two).text, HasSubstr("A-1, B-2; say which by --trajectory"));
  EXPECT_EQ(Parsed(two, {.north = North::kGrid, .trajectory = "B-2"}).head.names.survey, "B-2");
  EXPECT_THAT(ParseFault(two, {.trajectory = "C"}).text, HasSubstr("A-1, B-2"));
  EXPECT_THAT(ParseFault("DEPTH 9\nWELLPLANS:\n" + Plan("A")).text, HasSubstr("units 1 to 4"));
  EXPECT_THAT(ParseFault("! none\nWELLPLANS:\n" + Plan("A")).text, HasSubstr("DEPTH"));
  // What holds across is feet where the depths are metres: east by 76.76 ft does not fit the
  // angles.
  EXPECT_FALSE(ParseSurvey("DEPTH 3\nWELLPLANS:\n" + Plan("A"), "text"));
}

using Parts = std::map<std::string, std::string>;

std::string Zip(const Parts& parts) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* const out = zip_source_buffer_create(nullptr, 0, 0, &error);
  zip_source_keep(out);
  zip_t* const archive = zip_open_from_source(out, ZIP_TRUNCATE, &error);
  for (const auto& [name, text] : parts) {
    zip_source_t* const part = zip_source_buffer(archive, text.data(), text.size(), 0);
    zip_file_add(archive, name.c_str(), part, ZIP_FL_OVERWRITE);
  }
  zip_close(archive);
  zip_source_open(out);
  zip_source_seek(out, 0, SEEK_END);
  std::string bytes(static_cast<std::size_t>(zip_source_tell(out)), '\0');
  zip_source_seek(out, 0, SEEK_SET);
  zip_source_read(out, bytes.data(), bytes.size());
  zip_source_close(out);
  zip_source_free(out);
  return bytes;
}

Parts Book() {
  return {
      {"xl/workbook.xml",
       "<workbook xmlns:r=\"x\"><sheets><sheet name=\"Survey\" sheetId=\"1\" r:id=\"rId1\"/>"
       "<sheet name=\"Empty\" sheetId=\"2\" r:id=\"rId2\"/></sheets></workbook>"},
      {"xl/_rels/workbook.xml.rels",
       "<Relationships><Relationship Id=\"rId1\" Target=\"worksheets/sheet1.xml\"/>"
       "<Relationship Id=\"rId2\" Target=\"/xl/worksheets/sheet2.xml\"/></Relationships>"},
      {"xl/sharedStrings.xml",
       "<sst><si><t>MD[ft]</t></si><si><r><t>INC</t></r><r><t>[deg]</t></r></si></sst>"},
      {"xl/worksheets/sheet1.xml",
       "<worksheet><sheetData><row r=\"1\"><c r=\"A1\" t=\"inlineStr\"><is><t>Well: A-1</t>"
       "</is></c></row><row r=\"3\"><c r=\"B3\" t=\"s\"><v>0</v></c><c r=\"C3\" t=\"s\"><v>1</v>"
       "</c><c t=\"inlineStr\"><is><t>AZI_GRID[deg]</t></is></c></row>"
       "<row r=\"4\"><c r=\"B4\"><v>0</v></c><c r=\"C4\"><v>0</v></c><c r=\"D4\"><v>0</v></c></row>"
       "<row r=\"5\"><c r=\"B5\"><v>100</v></c><c r=\"C5\"><v>2.4999999999999996</v></c>"
       "<c r=\"D5\"><f>A1</f><v>90</v></c></row></sheetData></worksheet>"},
      {"xl/worksheets/sheet2.xml", "<worksheet><sheetData/></worksheet>"}};
}

TEST(Workbook, TheSheetThatIsFilled) {
  const SurveyTable t = Parsed(Zip(Book()));
  ASSERT_EQ(t.rows(), 2u);
  EXPECT_EQ(t.md(1), 100 * units::kFoot);
  EXPECT_EQ(t.inclination(1), 2.4999999999999996 * units::kDeg);
  EXPECT_EQ(t.azimuth(1), 90 * units::kDeg);
  EXPECT_EQ(t.head.azimuth.north, North::kGrid);
  Parts two = Book();
  two["xl/worksheets/sheet2.xml"] = two["xl/worksheets/sheet1.xml"];
  EXPECT_THAT(ParseFault(Zip(two)).text, HasSubstr("Survey, Empty; say which by --trajectory"));
  EXPECT_EQ(Parsed(Zip(two), {.trajectory = "Empty"}).rows(), 2u);
}

TEST(Workbook, FaultsNameTheRow) {
  Parts bad = Book();
  std::string& sheet = bad["xl/worksheets/sheet1.xml"];
  sheet.replace(sheet.find("<v>100"), 6, "<v>l00");
  const auto fault = ParseSurvey(Zip(bad), "text");
  ASSERT_FALSE(fault);
  EXPECT_EQ(fault.fault().line, 5);
  bad = Book();
  bad["xl/worksheets/sheet1.xml"] =
      "<worksheet><sheetData><row r=\"1\"><c r=\"A1\" t=\"s\">"
      "<v>7</v></c></row></sheetData></worksheet>";
  EXPECT_THAT(ParseFault(Zip(bad)).text, HasSubstr("does not hold"));
  EXPECT_THAT(ParseFault(Zip({{"readme", "x"}})).text, HasSubstr("no workbook"));
  bad["xl/worksheets/sheet1.xml"] =
      "<worksheet><sheetData><row r=\"2000000\"/></sheetData>"
      "</worksheet>";
  EXPECT_THAT(ParseFault(Zip(bad)).text, HasSubstr("out of order"));
}

// An archive that unpacks to more than it may is left unread.
TEST(Workbook, ABombIsRefused) {
  Parts bomb = Book();
  bomb["xl/sharedStrings.xml"] = std::string((std::size_t{1} << 26) + 100'000, ' ');
  EXPECT_THAT(ParseFault(Zip(bomb)).text, HasSubstr("too large"));
}

TEST(Layouts, CutsAndFlipsHarmNothing) {
  const std::string book = Zip(Book());
  for (std::size_t size = 1; size < book.size(); size += 7) {
    EXPECT_FALSE(ParseSurvey(book.substr(0, size), "text")) << size;
  }
  for (std::size_t at = 0; at < book.size(); at += 5) {
    std::string flipped = book;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x20);
    const auto table = ParseSurvey(flipped, "text");
    if (table) {
      EXPECT_EQ(table->md(table->rows() - 1), 100 * units::kFoot) << at;
    }
  }
  const std::string las = std::string(kLas3Head) + kLas3Survey;
  for (const std::string& text : {las, std::string(kPetra)}) {
    for (std::size_t at = 0; at < text.size(); at += 3) {
      std::string flipped = text;
      flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
      static_cast<void>(ParseSurvey(flipped, "text"));
      static_cast<void>(ParseSurvey(text.substr(0, at), "text"));
    }
  }
}

}  // namespace
}  // namespace wellgyro
