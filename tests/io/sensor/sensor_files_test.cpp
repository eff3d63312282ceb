#include "wellgyro/io/sensor/sensor_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/result/summary.h"
#include "wellgyro/io/sensor/sensor_csv.h"
#include "wellgyro/io/sensor/sensor_survey.h"
#include "wellgyro/simulate/truth.h"

#include "support/scratch.h"
#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

using support::Scratch;

const testing::SmallHole kStands = {.inclination_deg = 35,
                                    .build_deg = 0.05,
                                    .azimuth_deg = 75,
                                    .latitude_deg = 57,
                                    .to_md = 230,
                                    .depth_hz = 2};

Simulation Stands() {
  Simulation simulation = SimulationOf(kStands);
  simulation.run.steps.clear();
  for (int i = 0; i <= 8; ++i) {
    if (i > 0) {
      simulation.run.steps.push_back(
          RunMove{.to_md = 28.0 * i + 3 * (i % 2), .speed = 0.5 + 0.05 * (i % 3), .ramp = 3});
    }
    simulation.run.steps.push_back(RunStop{.seconds = 70.0 + 13 * (i * i % 5)});
  }
  return simulation;
}

Job StandsJob() { return JobOf(kStands); }

/// The run as tables: samples with the tool's time and, where asked, UTC; marks; a tally.
struct Tables {
  std::string samples, depth, tally;
};
Tables TablesOf(const Simulation& simulation, bool with_utc, double utc_off = 0) {
  Tables t;
  t.samples = with_utc
                  ? "TOOL[ns],UTC[us],GX[deg/h],GY[deg/h],AX[m/s2],AY[m/s2],AZ[g]\r\n"
                  : "# of a memory tool\nTOOL[ns],GX[deg/h],GY[deg/h],AX[m/s2],AY[m/s2],AZ[g]\n";
  t.depth = "UTC[us],MD[m]\n";
  Simulator simulator(simulation);
  SimulatedStep step;
  while (simulator.Next(step)) {
    if (const auto* s = std::get_if<ImuSample>(&step)) {
      t.samples += fmt::format("{},", s->stamp.tool_time.ns);
      if (with_utc) {
        t.samples += fmt::format("{},", s->stamp.utc.ns / 1000 + std::llround(utc_off * 1e6));
      }
      t.samples += fmt::format("{},{},{},{},{}\n", s->w_IT_T.x() / units::kDegPerHour,
                               s->w_IT_T.y() / units::kDegPerHour, s->f_T.x(), s->f_T.y(),
                               s->f_T.z() / units::kStandardGravity);
    }
    if (const auto* mark = std::get_if<DepthMark>(&step)) {
      t.depth += fmt::format("{},{}\n", mark->utc.ns / 1000, mark->md);
    }
  }
  t.tally = "UTC[s],END_UTC[s],LENGTH[m]\n";
  const Truth& truth = simulator.truth();
  const double zero = static_cast<double>(simulation.streams.begin_utc.ns) * 1e-9;
  double begin = 0, md = 0;
  bool still = true;
  for (double at = 0.5; at <= truth.seconds() + 0.5; at += 0.5) {
    const TruthState now = truth.At(at);
    const bool rests = now.still && at <= truth.seconds();
    if (rests && !still) begin = at;
    if (!rests && still) {
      const double there = truth.At(begin).md;
      // People note whole seconds.
      t.tally += fmt::format("{:.0f},{:.0f},{:.3f}\n", zero + begin, zero + at, there - md);
      md = there;
    }
    still = rests;
  }
  return t;
}

struct Surveyed {
  Result<SensorReport> report;
  Survey survey;
  std::vector<Fault> faults;
};
Surveyed Do(const Scratch& scratch, const std::vector<std::string>& names, const Job& job) {
  std::vector<std::filesystem::path> files;
  for (const std::string& name : names) files.push_back(scratch.path() / name);
  testing::CollectingSink sink;
  Surveyor surveyor(job, sink);
  Result<SensorReport> report = PushSensorFiles(files, job, surveyor, sink);
  surveyor.Finish();
  return {std::move(report), surveyor.Current(0), sink.faults};
}

TEST(SensorFiles, SamplesAndDepthFromTablesGiveTheSurveyOfTheMessages) {
  const Simulation simulation = Stands();
  const Scratch scratch;
  const Tables tables = TablesOf(simulation, true);
  scratch.Write("tool.csv", tables.samples);
  scratch.Write("depth.csv", tables.depth);
  EXPECT_TRUE(IsSensorTable(scratch.path() / "tool.csv"));
  EXPECT_TRUE(IsSensorTable(scratch.path() / "depth.csv"));
  const Surveyed by_tables = Do(scratch, {"depth.csv", "tool.csv"}, StandsJob());
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

TEST(SensorFiles, AMemoryToolIsJoinedToTheTallyByItsStops) {
  const Simulation simulation = Stands();
  const Scratch scratch;
  const Tables tables = TablesOf(simulation, false);
  scratch.Write("tool.csv", tables.samples);
  scratch.Write("tally.csv", tables.tally);
  Job job = StandsJob();
  job.stations.every = 0;
  job.stations.at_stops = true;
  const Surveyed done = Do(scratch, {"tool.csv", "tally.csv"}, job);
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
  const Surveyed by_utc = Do(scratch, {"tool.csv", "utc.csv"}, StandsJob());
  const Surveyed by_tool = Do(scratch, {"tool.csv", "tool_depth.csv"}, StandsJob());
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
  const Surveyed alone = Do(scratch, {"tool.csv", "depth.csv"}, StandsJob());
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
  const Surveyed done = Do(scratch, {"utc.csv", "depth.csv"}, StandsJob());
  ASSERT_FALSE(done.report);
  EXPECT_EQ(done.report.fault().code, FaultCode::kConflict);
  EXPECT_NE(done.report.fault().text.find("which no sample has"), std::string::npos);
  scratch.Write("rest.csv", "TOOL[s],END_UTC[s],MD[m]\n0,1,10\n");
  EXPECT_FALSE(Do(scratch, {"utc.csv", "rest.csv"}, StandsJob()).report);
}

TEST(SensorFiles, AClockThatIsSetWrongIsTold) {
  const Scratch scratch;
  const Tables tables = TablesOf(Stands(), true, 60);
  scratch.Write("tool.csv", tables.samples);
  scratch.Write("tally.csv", tables.tally);
  const Surveyed done = Do(scratch, {"tool.csv", "tally.csv"}, StandsJob());
  ASSERT_TRUE(done.report);
  EXPECT_NEAR(done.report->stamps_less_stops.value_or(0), 60, 1.5);
  bool told = false;
  for (const Fault& fault : done.faults) told = told || fault.code == FaultCode::kConflict;
  EXPECT_TRUE(told);
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
  const Surveyed done = Do(scratch, {"still.csv"}, job);
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

TEST(SensorCsv, NamesTheLineAndColumnOfWhatItCannotUse) {
  struct Case {
    const char *text, *says;
    int line, column;
  };
  const std::string header = "TOOL[s],GX[deg/h],GY[deg/h],AX[g],AY[g],AZ[g]\n";
  for (const Case& c : std::initializer_list<Case>{
           {"0,1,2,0,0,-1\n0.1,1,x,0,0,-1\n", "\"x\" is no number", 3, 7},
           {"0,1,2,0,0,-1\n0.1,1,2,0,0,-1\n0.1,1,2,0,0,-1\n", "time does not go on", 4, 1},
           {"0,1,2,0,0,-1\nzero,1,2,0,0,-1\n", "is no number", 3, 1},
           {"0,1,2,0,0,-1\n1e300,1,2,0,0,-1\n", "is no time", 3, 1},
           {"0,1,2,0,0,-1\n9,1,2,0,0,-1\n", "two seconds apart", 0, 0},
           {"0,1,2,0,0,-1\n", "fewer than two samples", 0, 0}}) {
    const Scratch scratch;
    scratch.Write("a.csv", header + c.text);
    Result<SensorCsv> table = SensorCsv::Open(scratch.path() / "a.csv");
    std::optional<Fault> fault;
    if (table) {
      SensorCsv::Row row;
      while (table->Next(row)) {
      }
      fault = table->fault();
    } else {
      fault = table.fault();
    }
    ASSERT_TRUE(fault) << c.text;
    EXPECT_NE(fault->text.find(c.says), std::string::npos) << fault->text;
    if (c.line > 0) {
      EXPECT_EQ(fault->line, c.line);
      EXPECT_EQ(fault->column, c.column);
    }
  }
  EXPECT_FALSE(SensorTableOf("md,inc,azi"));
  EXPECT_EQ(SensorTableOf("UTC[us],MD[ft]"), SensorTable::kDepth);
  const Scratch scratch;
  scratch.Write("a.csv", "UTC[us],MD[fathom]\n1,2\n");
  EXPECT_NE(SensorCsv::Open(scratch.path() / "a.csv").fault().text.find("[fathom]"),
            std::string::npos);
  scratch.Write("a.csv", "UTC[us],MD[m],WHAT\n1,2,3\n");
  EXPECT_NE(SensorCsv::Open(scratch.path() / "a.csv").fault().text.find("WHAT"), std::string::npos);
  for (const auto& [text, says] : std::vector<std::pair<std::string, std::string>>{
           {"UTC[us],GX[deg/h],GY[deg/h],AX[g],AZ[g]\n1,2,3,4,5\n", "samples lacks AY"},
           {"GX[deg/h],GY[deg/h],AX[g],AY[g],AZ[g]\n1,2,3,4,5\n", "samples lacks UTC or TOOL"},
           {"TOOL[s],DURATION[s],GY[deg/h],AX[g],AY[g],AZ[g]\n1,2,3,4,5,6\n",
            "averages lacks GX, UTC"},
           {"MD[m]\n1\n", "depths lacks UTC"},
           {"UTC[us],TEMP[degC]\n1,2\n", "depths lacks MD or LENGTH"},
           {"a,b,c\n1,2,3\n", "text of an unknown kind, no table"},
           {"MD[m],WHAT\n1,2\n", "WHAT"},
           {"UTC,MD\n1,2\n", "UTC has no unit that is known: []; known are ns, us,"},
           {"TOOL[s],RUN[m]\n1,2\n", "RUN takes no unit, not [m]"},
           {"UTC[us],MD[fathom]\n1,2\n", "MD has no unit that is known: [fathom]; known are m, ft"},
           {"TOOL[s],AX[m/s]\n1,2\n", "[m/s]; known are m/s2, g, mg"},
           {"TOOL[s],AX[mgs]\n1,2\n", "[mgs]; known are mg, m/s2, g"},
           {"TOOL[s],TEMP[K]\n1,2\n", "TEMP takes degC or no unit, not [K]"},
           {"TOOL[s],GYY[deg/h]\n1,2\n",
            "is not known; is GY meant? Known are UTC, END_UTC, TOOL,"},
           {"TOOL[s],gz[deg/h]\n1,2\n", "is not known; is GZ meant?"},
           {"TOOL[s],WHAT\n1,2\n", "column \"WHAT\" is not known; known are UTC, END_UTC, TOOL,"},
           {"\xED\xA1\xDA\x01\x01\x02,\xFF", "an LCM log, no table"}}) {
    scratch.Write("a.csv", text);
    const Result<SensorCsv> table = SensorCsv::Open(scratch.path() / "a.csv");
    ASSERT_FALSE(table) << text;
    EXPECT_NE(table.fault().text.find(says), std::string::npos) << table.fault().text;
    EXPECT_EQ(IsSensorTable(scratch.path() / "a.csv"), says.find("no table") == std::string::npos);
  }
  EXPECT_FALSE(SensorCsv::Open(scratch.path() / "absent.csv"));
  EXPECT_FALSE(SensorCsv::Open(scratch.path()));
}

TEST(SensorCsv, AnEmptyFieldHasAPlaceToo) {
  const Scratch scratch;
  scratch.Write("a.csv", "UTC[s],MD[m],RUN\n100,10,1\n101, ,1\n");
  Result<SensorCsv> table = SensorCsv::Open(scratch.path() / "a.csv");
  ASSERT_TRUE(table) << table.fault().text;
  SensorCsv::Row row;
  EXPECT_TRUE(table->Next(row));
  EXPECT_FALSE(table->Next(row));
  ASSERT_TRUE(table->fault());
  EXPECT_EQ(table->fault()->text, "a depth is missing");
  EXPECT_EQ(table->fault()->line, 3);
  EXPECT_EQ(table->fault()->column, 5);
}

TEST(SensorCsv, GapsAndMissingValuesAreLostSamples) {
  const Scratch scratch;
  scratch.Write("a.csv",
                "\xEF\xBB\xBFTOOL[ms],GX[deg/h],GY[deg/h],AX[g],AY[g],AZ[g]\r\n0,1,2,0,0,-1\r\n"
                "100,1,2,0,0,-1\r\n200,,2,0,0,-1\r\n300,1,2,0,0,-1\r\n700,1,2,0,0,-1\r\n");
  Result<SensorCsv> table = SensorCsv::Open(scratch.path() / "a.csv");
  ASSERT_TRUE(table) << table.fault().text;
  std::vector<std::int64_t> seqs;
  SensorCsv::Row row;
  while (table->Next(row)) seqs.push_back(std::get<ImuSample>(row).stamp.seq);
  EXPECT_FALSE(table->fault());
  EXPECT_EQ(seqs, (std::vector<std::int64_t>{0, 1, 3, 7}));
}

TEST(SensorCsv, ARowAtRestIsMarksAllTheWhile) {
  const Scratch scratch;
  scratch.Write("a.csv", "UTC[s],END_UTC[s],LENGTH[ft]\n100,110,30\n200,200,100\n");
  Result<SensorCsv> table = SensorCsv::Open(scratch.path() / "a.csv");
  ASSERT_TRUE(table);
  std::vector<DepthMark> marks;
  SensorCsv::Row row;
  while (table->Next(row)) marks.push_back(std::get<DepthMark>(row));
  ASSERT_EQ(marks.size(), 5u);
  EXPECT_EQ(marks[1].utc.ns, 104'000'000'000);
  EXPECT_EQ(marks[3].utc.ns, 110'000'000'000);
  EXPECT_TRUE(marks[3].stopped);
  EXPECT_NEAR(marks[3].md, 9.144, 1e-12);
  EXPECT_NEAR(marks[4].md, 39.624, 1e-12);
  EXPECT_EQ(marks[4].kind, DepthKind::kDrillPipe);
}

}  // namespace
}  // namespace wellgyro
