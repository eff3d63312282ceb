#include "wellgyro/io/sensor/sensor_files.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/result/summary.h"
#include "wellgyro/io/sensor/sensor_survey.h"
#include "wellgyro/simulate/truth.h"

#include "io/sensor/stands.h"
#include "support/scratch.h"
#include "support/simulated_survey.h"

namespace wellgyro {
namespace {

using support::Scratch;
using test::Do;
using test::Stands;
using test::StandsJob;
using test::StandsTables;
using test::SurveyedTables;
using test::TablesOf;

TEST(SensorFiles, SamplesAndDepthFromTablesGiveTheSurveyOfTheMessages) {
  const Simulation simulation = Stands();
  const Scratch scratch;
  const StandsTables tables = TablesOf(simulation, true);
  scratch.Write("tool.csv", tables.samples);
  scratch.Write("depth.csv", tables.depth);
  EXPECT_TRUE(IsSensorTable(scratch.path() / "tool.csv"));
  EXPECT_TRUE(IsSensorTable(scratch.path() / "depth.csv"));
  const SurveyedTables by_tables = Do(scratch, {"depth.csv", "tool.csv"}, StandsJob());
  ASSERT_TRUE(by_tables.report) << by_tables.report.fault().text;
  ASSERT_EQ(by_tables.survey.unusable, "");
  EXPECT_TRUE(by_tables.faults.empty());
  Sink sink;
  const Survey by_messages = testing::SurveyOf(simulation, StandsJob(), sink);
  ASSERT_EQ(by_tables.survey.chosen.size(), by_messages.chosen.size());
  for (std::size_t i = 0; i < by_messages.chosen.size(); ++i) {
    const Station &a = by_tables.survey.chosen[i], &b = by_messages.chosen[i];
    EXPECT_NEAR(a.md, b.md, 1e-6);
    // The messages have the modes too, at which windows are cut, and knots with them.
    EXPECT_NEAR(a.inclination, b.inclination, 3e-6);
    EXPECT_NEAR(WrapPi(a.azimuth - b.azimuth), 0, 1e-4);
  }
  const std::array<std::filesystem::path, 2> files{scratch.path() / "tool.csv",
                                                   scratch.path() / "depth.csv"};
  const Result<TableSurvey> in_one_call = SurveyTables(StandsJob(), files);
  ASSERT_TRUE(in_one_call) << in_one_call.fault().text;
  EXPECT_EQ(SurveyCsv(in_one_call->tools.at(0).chosen, nullptr),
            SurveyCsv(by_tables.survey.chosen, nullptr));
  EXPECT_EQ(in_one_call->tally.received, by_tables.report->samples);
  ASSERT_TRUE(by_tables.report->clock) << "the stamps are checked by the stops";
  EXPECT_LT(std::abs(by_tables.report->stamps_less_stops.value_or(99)), 1);
}

// One row of samples and one of depth that a logger wrote twice.
TEST(SensorFiles, ARepeatedRowIsLeftOutAndTold) {
  const Scratch scratch;
  StandsTables tables = TablesOf(Stands(), true);
  const auto twice = [](std::string& text) {
    const std::size_t begin = text.find('\n', text.size() / 2) + 1;
    const std::size_t end = text.find('\n', begin) + 1;
    text.insert(end, text.substr(begin, end - begin));
  };
  scratch.Write("once.csv", tables.samples);
  scratch.Write("depth.csv", tables.depth);
  const SurveyedTables once = Do(scratch, {"depth.csv", "once.csv"}, StandsJob());
  twice(tables.samples);
  twice(tables.depth);
  scratch.Write("twice.csv", tables.samples);
  scratch.Write("marks.csv", tables.depth);
  const SurveyedTables done = Do(scratch, {"marks.csv", "twice.csv"}, StandsJob());
  ASSERT_TRUE(done.report) << done.report.fault().text;
  EXPECT_EQ(SurveyCsv(done.survey.chosen, nullptr), SurveyCsv(once.survey.chosen, nullptr));
  EXPECT_EQ(done.report->samples, once.report->samples);
  ASSERT_EQ(done.faults.size(), 2u);
  for (const Fault& fault : done.faults) {
    EXPECT_EQ(fault.text, "1 row is the row before again: left out");
    EXPECT_GT(fault.line, 2);
  }
}

TEST(SensorFiles, AMemoryToolIsJoinedToTheTallyByItsStops) {
  const Simulation simulation = Stands();
  const Scratch scratch;
  const StandsTables tables = TablesOf(simulation, false);
  scratch.Write("tool.csv", tables.samples);
  scratch.Write("tally.csv", tables.tally);
  Job job = StandsJob();
  job.stations.every = 0;
  job.stations.at_stops = true;
  const SurveyedTables done = Do(scratch, {"tool.csv", "tally.csv"}, job);
  ASSERT_TRUE(done.report) << done.report.fault().text;
  ASSERT_TRUE(done.report->clock);
  EXPECT_GE(done.report->clock->matched, 7);
  const UtcTime begin = done.report->clock->ToUtc(ToolTime{});
  const double off = (begin - simulation.streams.begin_utc).seconds();
  EXPECT_LT(std::abs(off), 1.0) << "joined without a first guess";
  EXPECT_LT(std::abs(off), 4 * done.report->clock->Sigma(ToolTime{}) + 0.3);
  ASSERT_EQ(done.survey.unusable, "");
  EXPECT_NE(done.survey.verdict.verdict, Verdict::kFail) << VerdictText(done.survey.verdict);
  ASSERT_GE(done.survey.chosen.size(), 8u);
  const Truth truth(simulation);
  for (const Station& s : done.survey.chosen) {
    const WellPoint point = truth.well().PointAt(s.md);
    EXPECT_NEAR(s.inclination, point.inclination, FromDegrees(0.03)) << s.md;
    EXPECT_NEAR(WrapPi(s.azimuth - point.azimuth), 0,
                5 * std::sqrt(s.cov_md_inc_azi(2, 2)) + FromDegrees(0.01));
    EXPECT_LT(std::sqrt(s.cov_md_inc_azi(2, 2)), FromDegrees(0.5)) << s.md;
    EXPECT_LT((s.p_WT_W - truth.well().PlaceAt(s.md).p_WT_W).norm(), 1.5) << s.md;
  }
}

TEST(SensorFiles, AveragesAtRestMakeASurveyByThemselves) {
  const Simulation simulation = Stands();
  const Truth truth(simulation);
  std::string text =
      "UTC[us],DURATION[s],MD[m],GX[deg/h],GY[deg/h],GZ[deg/h],AX[g],AY[g],AZ[g],"
      "SIG_GX[deg/h],SIG_GY[deg/h],SIG_GZ[deg/h]\n";
  double last = -1;
  for (double t = 30; t < truth.seconds(); t += 5) {
    const TruthState state = truth.At(t);
    if (!state.still || !truth.At(t + 15).still || state.md < last + 1) continue;
    last = state.md;
    const SensorTruth s = truth.SensorsAt(t);
    text += fmt::format("{},15,{},{},{},{},{},{},{},0.05,0.05,0.05\n",
                        1'700'000'000'000'000 + std::llround(t * 1e6), state.md,
                        s.w_IT_T.x() / units::kDegPerHour, s.w_IT_T.y() / units::kDegPerHour,
                        s.w_IT_T.z() / units::kDegPerHour, s.f_T.x() / units::kStandardGravity,
                        s.f_T.y() / units::kStandardGravity, s.f_T.z() / units::kStandardGravity);
  }
  const Scratch scratch;
  scratch.Write("still.csv", text);
  Job job = StandsJob();
  job.stations.every = 0;
  job.stations.at_stops = true;
  const SurveyedTables done = Do(scratch, {"still.csv"}, job);
  ASSERT_TRUE(done.report) << done.report.fault().text;
  ASSERT_EQ(done.survey.unusable, "");
  EXPECT_EQ(done.report->windows, 9);
  ASSERT_GE(done.survey.chosen.size(), 9u);
  for (const Station& s : done.survey.chosen) {
    const WellPoint point = truth.well().PointAt(s.md);
    EXPECT_NEAR(s.inclination, point.inclination, FromDegrees(0.001)) << s.md;
    EXPECT_NEAR(WrapPi(s.azimuth - point.azimuth), 0, FromDegrees(0.01)) << s.md;
  }
}

}  // namespace
}  // namespace wellgyro
