#include "wellgyro/io/exchange/survey_csv.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

const std::string kHeader =
    "MD[m],INC[deg],AZI_TRUE[deg],GTF[deg],TVD[m],N[m],E[m],DLS[deg/30m],VAR_NN[m2],COV_NE[m2],"
    "COV_NV[m2],VAR_EE[m2],COV_EV[m2],VAR_VV[m2],SIG_INC[deg],SIG_AZI[deg],KIND,QUALITY";

std::vector<Station> SmallSurvey() {
  Station tie;
  tie.kind = StationKind::kTieIn;
  tie.md = 100;
  tie.p_WT_W = {-0.00001, 2, 99.5};
  tie.azimuth = FromDegrees(359.9999999);
  Station s;
  s.kind = StationKind::kContinuous;
  s.status = StationStatus::kField;
  s.run = 2;
  s.pass = Pass::kOut;
  s.revision = 3;
  s.quality = Quality::kGap | Quality::kMirror;
  s.md = 110.25;
  s.inclination = FromDegrees(12.3456789);
  s.azimuth = FromDegrees(271.5);
  s.toolface = FromDegrees(-90);
  s.p_WT_W = {0.0321, -12345.67894, 109.7};
  s.dogleg_severity = 1.5 * units::kDegPer30m;
  s.cov_p_WT_W << 1.0 / 3, -2e-7, 0, -2e-7, 12345678901.0, 0.25, 0, 0.25, 4;
  s.cov_md_inc_azi(0, 0) = 0.3 * 0.3;
  s.cov_md_inc_azi(1, 1) = std::pow(FromDegrees(0.02), 2);
  s.cov_md_inc_azi(2, 2) = std::pow(FromDegrees(0.5), 2);
  return {tie, s};
}

const std::string kTieRow =
    "100.0000,0.000000,0.000000,0.000000,99.5000,0.0000,2.0000,0.000000,0,0,0,0,0,0,0.000000,"
    "0.000000,tie_in,good";
const std::string kRow =
    "110.2500,12.345679,271.500000,270.000000,109.7000,0.0321,-12345.6789,1.500000,0.333333333,"
    "-2e-07,0,1.23456789e+10,0.25,4,0.020000,0.500000,continuous,mirror+gap";

TEST(SurveyCsv, IsAsTheDesignSaysToTheByte) {
  EXPECT_EQ(SurveyCsv(SmallSurvey(), nullptr), kHeader + "\n" + kTieRow + "\n" + kRow + "\n");
  EXPECT_EQ(SurveyCsv({}, nullptr), kHeader + "\n");
}

TEST(SurveyCsv, AnUnfitStationHasNoSigma) {
  std::vector<Station> stations = SmallSurvey();
  stations[1].quality = Quality::kUnfit;
  const std::string row =
      "110.2500,12.345679,271.500000,270.000000,109.7000,0.0321,-12345.6789,1.500000,,,,,,,,,"
      "continuous,unfit";
  const std::string text = kHeader + "\n" + kTieRow + "\n" + row + "\n";
  EXPECT_EQ(SurveyCsv(stations, nullptr), text);
  const auto read = ParseSurveyCsv(text, "a.csv");
  ASSERT_TRUE(read) << read.fault().text;
  EXPECT_EQ((*read)[1].quality, Quality::kUnfit);
  EXPECT_EQ(SurveyCsv(*read, nullptr), text);
  const std::string good = text.substr(0, text.size() - 6) + "good\n";
  EXPECT_FALSE(ParseSurveyCsv(good, "a.csv")) << "no other may lack it";
}

TEST(PassesCsv, IsAsTheDesignSaysToTheByte) {
  EXPECT_EQ(PassesCsv(SmallSurvey(), nullptr),
            "RUN,PASS,STATUS,REVISION," + kHeader + ",SIG_MD[m]\n0,stationary,provisional,0," +
                kTieRow + ",0\n2,out,field,3," + kRow + ",0.3\n");
}

TEST(SurveyCsv, GridColumnsComeLast) {
  // On the central meridian convergence is 0 and the scale 0.9996.
  GridSpec spec = UtmGrid("31N");
  const WellGrid grid(spec, {0, FromDegrees(3)});
  Station s;
  s.md = 10;
  s.azimuth = FromDegrees(30);
  s.p_WT_W = {1000, 0, 0};
  const std::string text = SurveyCsv(std::vector{s}, &grid);
  EXPECT_THAT(text, testing::StartsWith(kHeader + ",AZI_GRID[deg],NORTHING[m],EASTING[m]\n"));
  EXPECT_THAT(text, testing::EndsWith(",continuous,good,30.000000,999.6000,500000.0000\n"));
  spec.convergence = FromDegrees(31);
  const WellGrid stated(spec, {0, FromDegrees(3)});
  EXPECT_THAT(SurveyCsv(std::vector{s}, &stated), HasSubstr(",good,359.000000,"));
}

TEST(ChecksCsv, LeavesEmptyWhatThereIsNot) {
  const Check done{.code = "gravity",
                   .run = 1,
                   .pass = Pass::kIn,
                   .md = 250,
                   .value = -0.00125,
                   .sigma = 0.002,
                   .limit = 0.006,
                   .unit = "m/s2",
                   .limit_source = "3 sigma, \"own\"",
                   .verdict = Verdict::kPass};
  Check missing;
  missing.code = "foresight";
  missing.unit = "deg";
  missing.limit_source = "acceptance";
  EXPECT_EQ(ChecksCsv(std::vector{done, missing}),
            "CODE,RUN,PASS,MD[m],VALUE,SIGMA,LIMIT,UNIT,LIMIT_SOURCE,VERDICT\n"
            "gravity,1,in,250.0000,-0.00125,0.002,0.006,m/s2,\"3 sigma, \"\"own\"\"\",pass\n"
            "foresight,0,,,,,,deg,acceptance,not_done\n");
}

TEST(ParseSurveyCsv, RoundTripGivesTheSameBytes) {
  const std::string text = SurveyCsv(SmallSurvey(), nullptr);
  const auto stations = ParseSurveyCsv(text, "survey.csv");
  ASSERT_TRUE(stations) << stations.fault().text;
  ASSERT_EQ(stations->size(), 2u);
  const Station& s = (*stations)[1];
  EXPECT_EQ(s.md, 110.25);
  EXPECT_NEAR(s.inclination, FromDegrees(12.345679), 1e-15);
  EXPECT_NEAR(s.azimuth, FromDegrees(271.5), 1e-15);
  const double across = std::sin(FromDegrees(12.345679));
  EXPECT_LT((s.tangent_L - Eigen::Vector3d(across * std::cos(FromDegrees(271.5)),
                                           across * std::sin(FromDegrees(271.5)),
                                           std::cos(FromDegrees(12.345679))))
                .norm(),
            4e-16);
  EXPECT_EQ(s.p_WT_W, Eigen::Vector3d(0.0321, -12345.6789, 109.7));
  EXPECT_EQ(s.cov_p_WT_W(2, 1), 0.25);
  EXPECT_EQ(s.cov_p_WT_W(1, 0), -2e-7);
  EXPECT_EQ(s.quality, Quality::kGap | Quality::kMirror);
  EXPECT_EQ(SurveyCsv(*stations, nullptr), text);
}

TEST(ParseSurveyCsv, TakesWindowsLinesAndByteOrderMarksAndGrids) {
  const auto stations = ParseSurveyCsv("\xEF\xBB\xBF" + kHeader + "\r\n" + kRow + "\r\n", "x");
  ASSERT_TRUE(stations);
  EXPECT_EQ(stations->size(), 1u);
  const auto gridded = ParseSurveyCsv(
      kHeader + ",AZI_GRID[deg],NORTHING[m],EASTING[m]\n" + kRow + ",1.0,2.0,3.0", "x");
  ASSERT_TRUE(gridded);
  EXPECT_EQ(gridded->size(), 1u);
}

std::string With(std::size_t field, const std::string& value) {
  std::string row = kRow;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < field; ++i) begin = row.find(',', begin) + 1;
  const std::size_t end = std::min(row.find(',', begin), row.size());
  return kHeader + "\n" + kTieRow + "\n" + row.replace(begin, end - begin, value) + "\n";
}

TEST(ParseSurveyCsv, FaultsNameLineAndColumn) {
  ASSERT_TRUE(ParseSurveyCsv(With(0, "110.2500"), "x"));
  for (std::size_t field = 0; field < 18; ++field) {
    for (const char* odd : {"", "x", "1,0", "nan", "inf", "1e999", " 1", "0x10"}) {
      const auto odd_one = ParseSurveyCsv(With(field, odd), "survey.csv");
      ASSERT_FALSE(odd_one) << field << " " << odd;
      EXPECT_EQ(odd_one.fault().line, 3);
      EXPECT_EQ(odd_one.fault().source, "survey.csv");
    }
  }
  const Fault inclination = ParseSurveyCsv(With(1, "180.1"), "x").fault();
  EXPECT_EQ(inclination.code, FaultCode::kRange);
  EXPECT_EQ(inclination.column, 10);
  EXPECT_FALSE(ParseSurveyCsv(With(0, "100.0000"), "x"));  // not below the tie-in
  EXPECT_FALSE(ParseSurveyCsv(With(8, "-1"), "x"));
  EXPECT_FALSE(ParseSurveyCsv(With(16, "guess"), "x"));
}

TEST(ParseSurveyCsv, EveryPrefixIsRightOrRefused) {
  const std::string text = SurveyCsv(SmallSurvey(), nullptr);
  for (std::size_t n = 0; n < text.size(); ++n) {
    const auto stations = ParseSurveyCsv(text.substr(0, n), "x");
    if (stations) {
      EXPECT_LE(stations->size(), 2u);
    }
  }
}

TEST(ParseSurveyCsv, ForeignFilesAreSaidToBe) {
  for (const char* foreign : {"", "\n", "md,inc,azi\n1,2,3\n", "\x89PNG\r\n\x1a\n"}) {
    const auto stations = ParseSurveyCsv(foreign, "x");
    ASSERT_FALSE(stations);
    EXPECT_EQ(stations.fault().code, FaultCode::kForeign);
  }
}

TEST(ReadSurveyCsv, AbsentFilesAndDirectoriesAreFaults) {
  EXPECT_EQ(ReadSurveyCsv("no/such/survey.csv").fault().code, FaultCode::kIo);
  EXPECT_EQ(ReadSurveyCsv(".").fault().code, FaultCode::kIo);
}

TEST(SurveyCsv, RefusesWhatCannotBeReadAgain) {
  const auto refused = [](auto change) {
    std::vector<Station> stations = SmallSurvey();
    change(stations[1]);
    EXPECT_THROW(PassesCsv(stations, nullptr), std::invalid_argument);
    try {
      SurveyCsv(stations, nullptr);
    } catch (const std::invalid_argument& why) {
      return std::string(why.what());
    }
    return std::string();
  };
  EXPECT_THAT(refused([](Station& s) { s.azimuth = std::nan(""); }),
              HasSubstr("station 1 of the survey: azimuth = nan"));
  EXPECT_THAT(refused([](Station& s) { s.md = HUGE_VAL; }), HasSubstr("md = inf"));
  EXPECT_THAT(refused([](Station& s) { s.cov_p_WT_W(1, 1) = -1; }), HasSubstr("cov_p_WT_W = -1"));
  EXPECT_THAT(refused([](Station& s) { s.cov_p_WT_W(0, 2) = HUGE_VAL; }), HasSubstr("cov_p_WT_W"));
  EXPECT_THAT(refused([](Station& s) { s.cov_md_inc_azi(2, 2) = -1; }),
              HasSubstr("cov_md_inc_azi = -1"));
}

TEST(SurveyCsv, WhatRoundingLeavesBelowZeroIsZero) {
  std::vector<Station> stations = SmallSurvey();
  stations[1].cov_p_WT_W(1, 1) = -1e-20;
  stations[1].cov_md_inc_azi(2, 2) = -1e-20;
  const auto read = ParseSurveyCsv(SurveyCsv(stations, nullptr), "survey.csv");
  ASSERT_TRUE(read) << read.fault().text;
  EXPECT_EQ((*read)[1].cov_p_WT_W(1, 1), 0);
  EXPECT_EQ((*read)[1].cov_md_inc_azi(2, 2), 0);
}

TEST(ChecksCsv, WhatIsNoFiniteNumberStaysEmpty) {
  Check check;
  check.code = "gravity";
  check.value = 1;
  check.sigma = std::nan("");
  check.md = HUGE_VAL;
  EXPECT_THAT(ChecksCsv({&check, 1}), HasSubstr("gravity,0,,,1,,,"));
}

}  // namespace
}  // namespace wellgyro
