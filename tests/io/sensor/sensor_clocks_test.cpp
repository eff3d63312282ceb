// The clocks of samples and of depth, in tables.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/sensor/clock_join_internal.h"
#include "wellgyro/io/sensor/sensor_csv.h"
#include "wellgyro/io/sensor/sensor_files.h"

#include "io/sensor/stands.h"
#include "support/scratch.h"

namespace wellgyro {
namespace {

using support::Scratch;
using test::Do;
using test::Stands;
using test::StandsJob;
using test::StandsTables;
using test::SurveyedTables;
using test::TablesOf;

/// Samples with both clocks, UTC running `rate` times as fast as the tool's, and the depths of that
/// run on either clock.
struct TwoClocks {
  std::string samples, depth_by_utc, depth_by_tool;
};
TwoClocks OnTwoClocks(const Simulation& simulation, double rate) {
  TwoClocks t{"TOOL[ns],UTC[us],GX[rad/s],GY[rad/s],AX[m/s2],AY[m/s2],AZ[m/s2]\n",
              "UTC[us],MD[m]\n", "TOOL[ns],MD[m]\n"};
  const std::int64_t zero = simulation.streams.begin_utc.ns;
  const auto utc_us = [&](std::int64_t tool_ns) {
    return zero / 1000 + std::llround(rate * static_cast<double>(tool_ns) * 1e-3);
  };
  Simulator simulator(simulation);
  SimulatedStep step;
  while (simulator.Next(step)) {
    if (const auto* s = std::get_if<ImuSample>(&step)) {
      const std::int64_t tool = s->stamp.tool_time.ns;
      t.samples += fmt::format("{},{},{},{},{},{},{}\n", tool, utc_us(tool), s->w_IT_T.x(),
                               s->w_IT_T.y(), s->f_T.x(), s->f_T.y(), s->f_T.z());
    }
    if (const auto* mark = std::get_if<DepthMark>(&step)) {
      const std::int64_t tool = mark->utc.ns - zero;
      t.depth_by_utc += fmt::format("{},{}\n", utc_us(tool), mark->md);
      t.depth_by_tool += fmt::format("{},{}\n", tool, mark->md);
    }
  }
  return t;
}

void ExpectSame(const Survey& a, const Survey& b) {
  ASSERT_EQ(a.unusable, "");
  ASSERT_GT(a.chosen.size(), 5u);
  ASSERT_EQ(a.chosen.size(), b.chosen.size());
  for (std::size_t i = 0; i < a.chosen.size(); ++i) {
    EXPECT_NEAR(a.chosen[i].md, b.chosen[i].md, 1e-5);
    EXPECT_NEAR(a.chosen[i].inclination, b.chosen[i].inclination, 1e-7);
    EXPECT_NEAR(WrapPi(a.chosen[i].azimuth - b.chosen[i].azimuth), 0, 1e-6);
  }
}

TEST(SensorFiles, DepthOnTheToolsClockGivesTheSurveyOfDepthByUtc) {
  const TwoClocks tables = OnTwoClocks(Stands(), 1 + 2e-4);
  const Scratch scratch;
  scratch.Write("tool.csv", tables.samples);
  scratch.Write("utc.csv", tables.depth_by_utc);
  scratch.Write("tool_depth.csv", tables.depth_by_tool);
  EXPECT_TRUE(IsSensorTable(scratch.path() / "tool_depth.csv"));
  const SurveyedTables by_utc = Do(scratch, {"tool.csv", "utc.csv"}, StandsJob());
  const SurveyedTables by_tool = Do(scratch, {"tool.csv", "tool_depth.csv"}, StandsJob());
  ASSERT_TRUE(by_tool.report) << by_tool.report.fault().text;
  EXPECT_EQ(by_tool.report->marks, by_utc.report->marks);
  ExpectSame(by_tool.survey, by_utc.survey);
}

TEST(SensorFiles, OneClockForSamplesAndDepthNeedsNoUtc) {
  const TwoClocks tables = OnTwoClocks(Stands(), 1);
  std::string samples = "TOOL[ns],GX[rad/s],GY[rad/s],AX[m/s2],AY[m/s2],AZ[m/s2]\n";
  for (std::size_t begin = tables.samples.find('\n') + 1; begin < tables.samples.size();) {
    const std::size_t end = tables.samples.find('\n', begin) + 1;
    const std::size_t utc = tables.samples.find(',', begin),
                      rest = tables.samples.find(',', utc + 1);
    samples += tables.samples.substr(begin, utc - begin) + tables.samples.substr(rest, end - rest);
    begin = end;
  }
  const Scratch scratch;
  scratch.Write("tool.csv", samples);
  scratch.Write("both.csv", tables.samples);
  scratch.Write("depth.csv", tables.depth_by_tool);
  scratch.Write("utc.csv", tables.depth_by_utc);
  const SurveyedTables alone = Do(scratch, {"tool.csv", "depth.csv"}, StandsJob());
  ASSERT_TRUE(alone.report) << alone.report.fault().text;
  EXPECT_FALSE(alone.report->clock) << "there is no second clock to join";
  ExpectSame(alone.survey, Do(scratch, {"both.csv", "utc.csv"}, StandsJob()).survey);
  EXPECT_TRUE(std::none_of(alone.survey.chosen.begin(), alone.survey.chosen.end(),
                           [](const Station& s) { return Has(s.quality, Quality::kClock); }));
}

TEST(SensorFiles, DepthOnAClockThatNoSampleHasIsRefused) {
  const Scratch scratch;
  scratch.Write("utc.csv",
                "UTC[s],GX[deg/h],GY[deg/h],AX[g],AY[g],AZ[g]\n9,1,2,0,0,-1\n10,1,2,0,0,-1\n");
  scratch.Write("depth.csv", "TOOL[s],MD[m]\n0,10\n1,10\n");
  const SurveyedTables done = Do(scratch, {"utc.csv", "depth.csv"}, StandsJob());
  ASSERT_FALSE(done.report);
  EXPECT_EQ(done.report.fault().code, FaultCode::kConflict);
  EXPECT_NE(done.report.fault().text.find("which no sample has"), std::string::npos);
  scratch.Write("rest.csv", "TOOL[s],END_UTC[s],MD[m]\n0,1,10\n");
  EXPECT_FALSE(Do(scratch, {"utc.csv", "rest.csv"}, StandsJob()).report);
}

Simulation SlowStands() {
  Simulation simulation = Stands();
  for (RunStep& step : simulation.run.steps) {
    if (auto* move = std::get_if<RunMove>(&step)) move->ramp = 10;
  }
  return simulation;
}

/// By which a tie is off [s]; the simulation's two clocks go alike.
double ErrorAt(ToolTime time, const StopMatch& match, const Simulation& simulation) {
  const Duration truth = time - ToolTime{};
  return (match.ToUtc(time) - simulation.streams.begin_utc - truth).seconds();
}

// A string that takes ten seconds to come to its speed is within two centimetres of its rest for
// 0.9 s more, before it as after it.
TEST(ClockJoin, RestsTellTheOffsetWithinTheStepsOfTheirEnds) {
  for (const Simulation& simulation : {Stands(), SlowStands()}) {
    const Scratch scratch;
    const StandsTables tables = TablesOf(simulation, false);
    scratch.Write("tool.csv", tables.samples);
    scratch.Write("depth.csv", tables.depth);
    const auto samples = scratch.path() / "tool.csv", depth = scratch.path() / "depth.csv";
    const auto joined = sensors::JoinByStops({samples, depth}, StandsJob());
    ASSERT_TRUE(joined) << joined.fault().text;
    const StopMatch& match = joined->match;
    const double sigma = match.Sigma(match.tool);
    EXPECT_LT(std::abs(ErrorAt(match.tool, match, simulation)), 3 * sigma);
    EXPECT_GT(sigma, 0.2) << "blocks of a second, marks twice a second";
    EXPECT_LT(sigma, 0.3);
  }
}

TEST(SensorFiles, ClocksAreJoinedByTheMotionThatIsFelt) {
  for (const Simulation& simulation : {Stands(), SlowStands()}) {
    const Scratch scratch;
    const StandsTables tables = TablesOf(simulation, false);
    scratch.Write("tool.csv", tables.samples);
    scratch.Write("depth.csv", tables.depth);
    const SurveyedTables done = Do(scratch, {"tool.csv", "depth.csv"}, StandsJob());
    ASSERT_TRUE(done.report) << done.report.fault().text;
    ASSERT_TRUE(done.report->clock);
    const StopMatch& match = *done.report->clock;
    const double sigma = match.Sigma(match.tool);
    EXPECT_LT(std::abs(ErrorAt(match.tool, match, simulation)), 3 * sigma);
    EXPECT_LT(std::abs(ErrorAt(ToolTime{}, match, simulation)), 3 * match.Sigma(ToolTime{}));
    EXPECT_LT(sigma, 0.02);
    const auto lag = std::ranges::find(done.survey.checks, "depth_lag", &Check::code);
    ASSERT_NE(lag, done.survey.checks.end());
    ASSERT_TRUE(lag->value && lag->sigma);
    EXPECT_GE(*lag->sigma, sigma) << "the tie's error is a lag of the marks";
    EXPECT_EQ(lag->verdict, Verdict::kPass);
    // With both clocks in the samples there is no tie by stops to be unsure of.
    scratch.Write("both.csv", TablesOf(simulation, true).samples);
    const SurveyedTables both = Do(scratch, {"both.csv", "depth.csv"}, StandsJob());
    const auto sharp = std::ranges::find(both.survey.checks, "depth_lag", &Check::code);
    ASSERT_NE(sharp, both.survey.checks.end());
    EXPECT_LT(sharp->sigma.value_or(1), 0.5 * sigma);
  }
}

TEST(SensorFiles, AClockThatIsSetWrongIsTold) {
  const std::pair<double, const char*> wrong[] = {
      {60, "one of the clocks is set wrong"},
      {3600, "one of the clocks is in a time zone, 1 h from UTC"},
      {-5400, "one of the clocks is in a time zone, 1.5 h from UTC"}};
  for (const auto& [seconds, words] : wrong) {
    const Scratch scratch;
    const StandsTables tables = TablesOf(Stands(), true, seconds);
    scratch.Write("tool.csv", tables.samples);
    scratch.Write("tally.csv", tables.tally);
    const SurveyedTables done = Do(scratch, {"tool.csv", "tally.csv"}, StandsJob());
    ASSERT_TRUE(done.report);
    EXPECT_NEAR(done.report->stamps_less_stops.value_or(0), seconds, 1.5);
    const auto told = std::ranges::find(done.faults, FaultCode::kConflict, &Fault::code);
    ASSERT_NE(told, done.faults.end());
    EXPECT_THAT(told->text, testing::HasSubstr(words));
  }
}

}  // namespace
}  // namespace wellgyro
