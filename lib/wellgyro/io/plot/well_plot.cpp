#include "wellgyro/io/plot/well_plot.h"

#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/plot/map_chart.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

constexpr double kPanel = 560;  // pixels

MapPath PathOf(const SurveyedWell& well, std::string name) {
  MapPath path{.name = std::move(name), .points_W = well.position_W};
  for (const SurveyPoint& station : well.survey) path.md.push_back(station.md);
  return path;
}

/// The line between the two wells where they are closest.
void DrawNearest(Chart& chart, const Separation& nearest, const MapView& view) {
  chart.series.push_back(
      {.name = fmt::format("closest, {:.1f} m at MD {:.0f} m", nearest.distance, nearest.md),
       .mark = ChartSeries::Mark::kDash,
       .colour = 3,
       .points = {view(nearest.position_W), view(nearest.position_W + nearest.vector_W)}});
}

}  // namespace

std::string WellPlotSvg(const SurveyedWell& well, const PositionUncertainty& errors,
                        double confidence, const WellPlotLabels& labels) {
  ConfidenceFactor(confidence, 2);  // throws before anything is drawn
  MapPath path = PathOf(well, "well");
  for (std::size_t k = 0; k < errors.cov_p_W.size(); ++k)
    path.covs_W.emplace_back(k, errors.cov_p_W[k]);
  const double magnify = MagnificationOf(path, confidence);
  const MapView plan;
  const MapSection section = SectionThrough(path);
  Chart on_plan{.title = "Plan",
                .x_name = "east [m]",
                .y_name = "north [m]",
                .equal = true,
                .width = kPanel,
                .height = kPanel};
  Chart on_section{
      .title = "Vertical section",
      .x_name = fmt::format("along azimuth {:.1f} deg [m]", ToDegrees(section.azimuth)),
      .y_name = "TVD [m]",
      .y_down = true,
      .equal = true,
      .width = kPanel,
      .height = kPanel};
  for (const auto& [chart, view] :
       {std::pair(&on_plan, &plan), std::pair(&on_section, &section.view)}) {
    DrawOnMap(*chart, path, *view, confidence, magnify, "m");
    if (labels.other) DrawBeside(*chart, PathOf(*labels.other, labels.other_name), *view, 0);
    if (labels.nearest) DrawNearest(*chart, *labels.nearest, *view);
  }
  std::vector<std::string> facts = labels.facts;
  facts.push_back(fmt::format("ellipses at {:g} %, half axes; one scale on both axes, the bar in m",
                              100 * confidence));
  return ChartSheetSvg(labels.title, facts, {on_plan, on_section});
}

}  // namespace wellgyro
