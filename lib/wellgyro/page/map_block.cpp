// Block 2: plan, vertical section, space, and how large the ellipse grows.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/plot/map_chart.h"
#include "wellgyro/page/html_internal.h"
#include "wellgyro/page/page_internal.h"
#include "wellgyro/page/space_internal.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Mark = ChartSeries::Mark;

constexpr int kSurveyColour = 0, kEllipseColour = 1;
constexpr std::size_t kNameShown = 40;  // letters of another well's

/// In the page's unit of length.
MapPath PathOf(const PageText& page, const Json& table, std::string name) {
  MapPath path{.name = std::move(name)};
  const Columns rows(table);
  for (std::size_t i = 0; i < rows.rows(); ++i) {
    const auto md = rows.Number(i, "MD[m]"), north = rows.Number(i, "N[m]"),
               east = rows.Number(i, "E[m]"), tvd = rows.Number(i, "TVD[m]");
    if (!md || !north || !east || !tvd) continue;
    const double unit = page.units.length;
    if (const auto cov = rows.Covariance(i)) {
      path.covs_W.emplace_back(path.points_W.size(), unit * unit * *cov);
    }
    path.points_W.push_back(unit * Vector3d(*north, *east, *tvd));
    path.md.push_back(unit * *md);
  }
  return path;
}

std::vector<SpaceSeries> InSpace(const MapPath& path, const std::vector<MapPath>& others,
                                 double magnify) {
  const auto place = [](const Vector3d& p) { return Vector3d(p.y(), p.x(), p.z()); };
  std::vector<SpaceSeries> series;
  const double sigmas = ConfidenceFactor(kConfidence, 2);
  for (const std::size_t i : EllipsesShown(path)) {
    const auto& [at, cov] = path.covs_W[i];
    const SeenEllipse seen = EllipseSeenAlong(cov, Vector3d::UnitZ(), sigmas);
    SpaceSeries ring{.mark = Mark::kArea, .colour = kEllipseColour};
    for (const Vector2d& u :
         EllipseOutline(Vector2d::Zero(), Vector2d::UnitX(), Vector2d::UnitY())) {
      ring.points.push_back(
          place(path.points_W[at] + magnify * (u.x() * seen.major + u.y() * seen.minor)));
    }
    series.push_back(std::move(ring));
  }
  SpaceSeries line{.name = path.name, .colour = kSurveyColour, .md = path.md};
  for (const Vector3d& p : path.points_W) line.points.push_back(place(p));
  series.push_back(std::move(line));
  int colour = 2;
  for (const MapPath& other : others) {
    SpaceSeries beside{.name = other.name, .colour = colour++};
    for (const Vector3d& p : other.points_W) beside.points.push_back(place(p));
    series.push_back(std::move(beside));
  }
  return series;
}

void AddGrowth(PageText& page, const MapPath& path) {
  Chart chart{.title = "95 % error ellipse along the hole (half axes) and 95 % of TVD",
              .x_name = page.Named("MD"),
              .y_name = page.Named("half axis"),
              .height = 220};
  ChartSeries major{.name = "long half axis", .colour = 1},
      minor{.name = "short half axis", .colour = 0},
      vertical{.name = "TVD \u00b1", .mark = Mark::kDash, .colour = 2};
  for (const auto& [at, cov] : path.covs_W) {
    const ErrorEllipse ellipse = HorizontalEllipse(cov, kConfidence);
    const double md = path.md[at];
    major.points.emplace_back(md, ellipse.semi_major);
    minor.points.emplace_back(md, ellipse.semi_minor);
    vertical.points.emplace_back(
        md, ConfidenceFactor(kConfidence, 1) * std::sqrt(std::max(cov(2, 2), 0.0)));
    for (ChartSeries* series : {&major, &minor, &vertical}) series->md.push_back(md);
  }
  chart.series = {std::move(major), std::move(minor), std::move(vertical)};
  AddChart(page, "growth", chart, true);
}

void AddMaps(PageText& page, const MapPath& path, const std::vector<MapPath>& others) {
  const MapView plan;
  const MapSection section = SectionThrough(path);
  const double magnify = MagnificationOf(path, kConfidence);
  const std::string unit(page.units.length_name);
  Chart on_plan{.title = "Plan",
                .x_name = page.Named("east"),
                .y_name = page.Named("north (true)"),
                .equal = true,
                .height = 470};
  Chart on_section{
      .title = "Vertical section",
      .x_name = page.Named(fmt::format("along azimuth {:.2f}\u00b0", ToDegrees(section.azimuth))),
      .y_name = page.Named("TVD"),
      .y_down = true,
      .equal = true,
      .height = 470};
  for (const auto& [chart, view] :
       {std::pair(&on_plan, &plan), std::pair(&on_section, &section.view)}) {
    DrawOnMap(*chart, path, *view, kConfidence, magnify, unit);
    int number = 0;
    for (const MapPath& other : others) DrawBeside(*chart, other, *view, number++);
  }
  page.html += fmt::format(
      "<p>Both axes of each picture have one scale; the bar in its corner is in {}. Ellipses hold "
      "the "
      "position with 95 % in their plane.</p>\n",
      page.units.length_name);
  AddChart(page, "plan", on_plan, false);
  AddChart(page, "section", on_section, false);
  AddSpace(page, "space", "Path in space, horizontal 95 % ellipses",
           InSpace(path, others, magnify));
}

}  // namespace

void WriteMaps(PageText& page) {
  BeginBlock(page, 2, "Plan and vertical section");
  const MapPath path = PathOf(page, At(page.survey, {"stations"}), "survey");
  std::vector<MapPath> others;
  const Json& listed = At(page.survey, {"others"});
  if (listed.is_array()) {
    for (const Json& other : listed) {
      MapPath shown = PathOf(page, other, Clipped(TextAt(other, {"name"}), kNameShown));
      if (!shown.points_W.empty()) others.push_back(std::move(shown));
    }
  }
  if (path.points_W.size() < 2) {
    SayNotMeasured(page, "Path");
  } else {
    AddMaps(page, path, others);
    if (path.covs_W.empty()) {
      SayNotMeasured(page, "Error ellipses");
    } else {
      AddGrowth(page, path);
    }
  }
  EndBlock(page);
}

}  // namespace wellgyro
