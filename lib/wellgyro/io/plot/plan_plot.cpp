#include "wellgyro/io/plot/plan_plot.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/plot/chart.h"
#include "wellgyro/io/words.h"

namespace wellgyro {
namespace {

using Eigen::Vector2d;
using Mark = ChartSeries::Mark;

constexpr int kPlanColour = 0, kPracticeColour = 1, kNoneColour = 2;
constexpr double kPlanWidth = 620;  // pixels

Chart InclinationChart(const PlanCase& c, const StopPlan& plan) {
  Chart chart{.title = "Inclination, and where the tool stops",
              .x_name = "MD [m]",
              .y_name = "inclination [deg]",
              .width = kPlanWidth,
              .height = 260};
  const auto at = [&c](double md) {
    const double inside = std::clamp(md, c.well.md_begin(), c.well.md_end());
    return Vector2d(md, ToDegrees(c.well.AtMd(inside).inclination));
  };
  ChartSeries line{.colour = kHelpColour};
  constexpr int kPoints = 400;  // a point every 1.5 pixels of kPlanWidth
  for (int i = 0; i <= kPoints; ++i) {
    line.points.push_back(at(c.way.begin_md + (c.way.end_md - c.way.begin_md) * i / kPoints));
  }
  chart.series.push_back(std::move(line));
  for (const bool out : {false, true}) {
    ChartSeries stops{.name = out ? "stop on the way up" : "stop on the way down",
                      .mark = Mark::kFlag,
                      .colour = out ? kPracticeColour : kPlanColour};
    for (const PlannedStop& stop : plan.stops) {
      if (stop.out == out) stops.points.push_back(at(stop.md));
    }
    if (!stops.points.empty()) chart.series.push_back(std::move(stops));
  }
  return chart;
}

/// A bar of no width at each stop, as high as it is long.
ChartSeries Bars(const std::vector<PlannedStop>& stops, const std::string& name, int colour,
                 bool out) {
  ChartSeries bars{.name = name, .colour = colour};
  for (const PlannedStop& stop : stops) {
    if (stop.out != out) continue;
    for (const double seconds : {0., stop.seconds, 0.}) bars.points.emplace_back(stop.md, seconds);
  }
  return bars;
}

Chart TimeChart(const PlanCase& c, const StopPlan& plan, const std::vector<PlannedStop>& practice) {
  Chart chart{.title = "Time at rest",
              .x_name = "MD [m]",
              .y_name = "at rest [s]",
              .width = kPlanWidth,
              .height = 260};
  ChartSeries base{.colour = kHelpColour};
  base.points = {{c.way.begin_md, 0}, {c.way.end_md, 0}};
  chart.series.push_back(std::move(base));
  for (const auto& series : {Bars(practice, "practice", kPracticeColour, false),
                             Bars(plan.stops, "plan, way down", kPlanColour, false),
                             Bars(plan.stops, "plan, way up", 3, true)}) {
    if (!series.points.empty()) chart.series.push_back(series);
  }
  return chart;
}

std::vector<Vector2d> Closed(std::vector<Vector2d> outline) {
  if (!outline.empty()) outline.push_back(outline.front());
  return outline;
}

ChartSeries Ellipse(const ExpectedEnd& end, const std::string& name, int colour, Mark mark) {
  // East to the right, north up.
  const Vector2d major(std::sin(end.azimuth_major), std::cos(end.azimuth_major));
  const Vector2d minor(major.y(), -major.x());
  return {.name = name,
          .mark = mark,
          .colour = colour,
          .points = Closed(EllipseOutline({0, 0}, end.semi_major * major, end.semi_minor * minor))};
}

Chart EndChart(const PlanLimits& limits, const StopPlan& plan,
               const std::optional<ExpectedEnd>& practice) {
  Chart chart{.title = "95 % ellipse of the end",
              .x_name = "east [m]",
              .y_name = "north [m]",
              .equal = true,
              .width = 420,
              .height = 420};
  chart.series.push_back(
      {.name = "limit",
       .mark = Mark::kDash,
       .colour = kHelpColour,
       .points = Closed(EllipseOutline({0, 0}, {limits.ellipse, 0}, {0, limits.ellipse}))});
  if (plan.without.solved && plan.without.semi_major < 6 * limits.ellipse) {
    chart.series.push_back(Ellipse(plan.without, "without stops", kNoneColour, Mark::kLine));
  }
  if (practice && practice->solved) {
    chart.series.push_back(Ellipse(*practice, "practice", kPracticeColour, Mark::kLine));
  }
  if (plan.expected.solved) {
    chart.series.push_back(Ellipse(plan.expected, "plan", kPlanColour, Mark::kLine));
  }
  return chart;
}

}  // namespace

std::string PlanSvg(const std::string& title, const PlanCase& c, const PlanLimits& limits,
                    const StopPlan& plan, const std::vector<PlannedStop>& practice_stops,
                    const std::optional<ExpectedEnd>& practice) {
  std::vector<std::string> facts;
  if (plan.feasible) {
    facts.push_back(fmt::format("{}, {:.0f} s at rest; ellipse {:.2f} m of {:.2f} m",
                                Counted(plan.stops.size(), "stop"), plan.at_rest,
                                plan.expected.semi_major, limits.ellipse));
  } else {
    facts.push_back(plan.why_not);
  }
  return ChartSheetSvg(title, facts,
                       {InclinationChart(c, plan), TimeChart(c, plan, practice_stops),
                        EndChart(limits, plan, practice)});
}

}  // namespace wellgyro
