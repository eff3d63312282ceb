#include "wellgyro/io/toml/plan_file.h"

#include <gtest/gtest.h>

#include "wellgyro/io/plot/plan_plot.h"

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
