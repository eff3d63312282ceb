#include "wellgyro/io/toml/plan_file.h"

#include <gtest/gtest.h>

#include "wellgyro/io/plot/plan_plot.h"
#include "wellgyro/simulate/run_plan.h"

#include "plan/cases.h"

namespace wellgyro {
namespace {

const PlanReport& Example() {
  static const PlanReport report = [] {
    PlanReport r{.well = "slant.csv", .c = test::Slant(), .limits = {.ellipse = 7.5}, .plan = {}};
    r.c.way.speed_in = r.c.way.speed_out = 3;
    r.plan = PlanStops(r.c, r.limits);
    r.practice_stops = Practice(r.c.way, 300, 180);
    r.practice = ExpectEnd(r.c, r.practice_stops, true);
    r.worse = ExpectEnd(WorseTool(r.c, kWorseFactor), r.plan.stops, true);
    r.warnings = {"a \"quoted\" warning"};
    return r;
  }();
  return report;
}

TEST(PlanFile, ReadsBackAsItWasWritten) {
  const PlanReport& r = Example();
  ASSERT_TRUE(r.plan.feasible);
  const Result<PlanFile> file = ParsePlanFile(PlanToml(r), "plan.toml");
  ASSERT_TRUE(file) << file.fault().text;
  EXPECT_NEAR(file->way.roll_rate, r.c.way.roll_rate, 1e-6);
  EXPECT_EQ(file->way.end_md, 3000);
  ASSERT_EQ(file->stops.size(), r.plan.stops.size());
  for (std::size_t i = 0; i < file->stops.size(); ++i) {
    EXPECT_EQ(file->stops[i].out, r.plan.stops[i].out);
    EXPECT_NEAR(file->stops[i].md, r.plan.stops[i].md, 0.006);
    EXPECT_EQ(file->stops[i].seconds, r.plan.stops[i].seconds);
  }
}

TEST(PlanFile, HoldsWhatARunIsAdvisedBy) {
  const PlanReport& r = Example();
  Result<PlanFile> file = ParsePlanFile(PlanToml(r), "plan.toml");
  ASSERT_TRUE(file) << file.fault().text;
  EXPECT_EQ(file->limits.ellipse, r.limits.ellipse);
  EXPECT_EQ(file->limits.hidden, r.limits.hidden);
  EXPECT_EQ(file->limits.least_stop, r.limits.least_stop);
  EXPECT_EQ(file->limits.overhead, r.limits.overhead);
  Job job;
  job.well.latitude = r.c.site.latitude;
  job.noise = r.c.gyro;
  job.errors = r.c.errors;
  const PlanCase c = CaseOf(*file, job);
  const TrajectoryPoint there = c.well.AtMd(2500), planned = r.c.well.AtMd(2500);
  EXPECT_LT((there.position_W - planned.position_W).norm(), 0.01);
  EXPECT_NEAR(ExpectEnd(c, file->stops, false).semi_major, r.plan.expected.semi_major, 0.02);
  EXPECT_FALSE(c.sigma_start_azimuth);
  job.alignment.method = AlignmentSpec::Method::kExternal;
  job.alignment.sigma_azimuth = 0.01;
  EXPECT_EQ(CaseOf(*file, job).sigma_start_azimuth, 0.01);
  file->path.clear();
  EXPECT_THROW(CaseOf(*file, job), std::invalid_argument);
}

// As the simulator lays the steps out: its stops are the plan's, and a tool that slides swings on
// the move, and rests, as the plan has it; turned for a stop it is turned back.
TEST(PlanFile, ASimulatedRunGoesAsPlanned) {
  PlanFile plan;
  plan.way = test::SShape().way;
  plan.stops = {{false, 300, 90, {}}, {false, 1500, 120, {}}, {true, 2000, 60, 1.25}};
  SimulatedWell well;
  well.stations = {{300, 0.3, 1.9}, {2900, 0.3, 1.9}};
  const SimulatedRun run = RunOf(plan);
  const RunPlan laid(run, TruthWell(well, {}));
  std::vector<double> rested(3, 0.0);
  double deepest = 0, least = 0, most = 0;
  for (double t = 0; t <= laid.seconds(); ++t) {
    const RunMotion now = laid.At(t);
    deepest = std::max(deepest, now.md);
    const bool up = now.md < deepest;
    const double moved = (up ? 2 * deepest - now.md - 300 : now.md - 300) / 0.8;
    const double swung = plan.way.swing * std::sin(kTwoPi * moved / plan.way.swing_period);
    const double off = now.roll - 1.9 - plan.way.toolface;
    if (now.speed == 0 && up && now.md == 2000) {
      if (std::abs(off + plan.way.toolface - 1.25) < 1e-9 && now.still) ++rested[2];
      continue;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      if (now.still && now.md == plan.stops[i].md && !up) ++rested[i];
    }
    EXPECT_NEAR(off, swung, 1e-9) << t;
    least = std::min(least, off);
    most = std::max(most, off);
  }
  EXPECT_EQ(deepest, 2900);
  EXPECT_EQ(laid.At(laid.seconds()).md, 300);
  EXPECT_NEAR(least, -plan.way.swing, 1e-3);
  EXPECT_NEAR(most, plan.way.swing, 1e-3);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(rested[i], plan.stops[i].seconds, 1) << i;
}

TEST(PlanFile, RefusesMistakesWithTheirPlace) {
  const std::string run =
      "format = \"wellgyro.plan/1\"\n[run]\nbegin_md_m = 0.0\nend_md_m = 900.0\n";
  const auto why = [&](const std::string& more) {
    const Result<PlanFile> file = ParsePlanFile(run + more, "p.toml");
    return file ? std::string() : file.fault().text;
  };
  EXPECT_EQ(why(""), "");
  EXPECT_NE(why("[[stop]]\npass = \"in\"\nmd_m = 950\nstop_s = 60\n").find("not on the way"),
            std::string::npos);
  EXPECT_NE(why("[[stop]]\npass = \"up\"\nmd_m = 50\nstop_s = 60\n").find("pass"),
            std::string::npos);
  EXPECT_NE(why("[[stop]]\npass = \"out\"\nmd_m = 50\nstop_s = 60\n"
                "[[stop]]\npass = \"in\"\nmd_m = 90\nstop_s = 60\n")
                .find("does not follow"),
            std::string::npos);
  EXPECT_NE(why("rol_rpm = 1.0\n").find("rol_rpm"), std::string::npos);
  EXPECT_NE(why("[limits]\nellipse_m = -2.0\n").find("ellipse_m"), std::string::npos);
  EXPECT_NE(why("[limits]\nleast_stop_s = 90\nlongest_stop_s = 60\n").find("longest_stop_s"),
            std::string::npos);
  for (const char* rows : {"[[0, 0, 0]]", "[[0, 0, 0], [800, 0, 0]]", "[[0, 0, 0], [900, 181, 0]]",
                           "[[0, 0, 0], [0, 0, 0], [900, 0, 0]]", "[[0, 0, 0], [900, nan, 0]]"}) {
    EXPECT_NE(why(std::string("[path]\nstations = ") + rows + "\n").find("stations"),
              std::string::npos)
        << rows;
  }
  EXPECT_NE(why("[[stop]]\npass = \"in\"\nmd_m = 50\nstop_s = nan\n"), "");
  const std::string text = PlanToml(Example());
  for (std::size_t n = 0; n < text.size(); n += 97) {
    const Result<PlanFile> cut = ParsePlanFile(text.substr(0, n), "p.toml");
    if (cut) {
      EXPECT_LE(cut->stops.size(), Example().plan.stops.size());
    }
  }
}

TEST(PlanPlot, ShowsStopsAndEllipses) {
  const PlanReport& r = Example();
  const std::string svg = PlanSvg("A <well>", r.c, r.limits, r.plan, r.practice_stops, r.practice);
  EXPECT_NE(svg.find("A &lt;well&gt;"), std::string::npos);
  for (const char* word : {"practice", "plan, way down", "limit", "Inclination"}) {
    EXPECT_NE(svg.find(word), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace wellgyro
