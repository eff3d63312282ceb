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
#include "wellgyro/io/plot/plot_text_internal.h"
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

constexpr double kConfidence = 0.95;
constexpr int kSurveyColour = 0, kEllipseColour = 1, kTickColour = 4;

/// A path in the page's unit of length: north, east, TVD.
struct PathShown {
  std::string name;
  std::vector<Vector3d> points;
  std::vector<double> md;
  std::vector<std::pair<std::size_t, Matrix3d>> covs;  ///< of its stations that have one
};

PathShown PathOf(const PageText& page, const Json& table, std::string name) {
  PathShown path{.name = std::move(name)};
  const Columns rows(table);
  for (std::size_t i = 0; i < rows.rows(); ++i) {
    const auto md = rows.Number(i, "MD[m]"), north = rows.Number(i, "N[m]"),
               east = rows.Number(i, "E[m]"), tvd = rows.Number(i, "TVD[m]");
    if (!md || !north || !east || !tvd) continue;
    const double unit = page.units.length;
    if (const auto cov = rows.Covariance(i))
      path.covs.emplace_back(path.points.size(), unit * unit * *cov);
    path.points.push_back(unit * Vector3d(*north, *east, *tvd));
    path.md.push_back(unit * *md);
  }
  return path;
}

/// Two directions of the paper.
struct View {
  Vector3d right, up_or_down;
  Vector2d operator()(const Vector3d& p) const { return {right.dot(p), up_or_down.dot(p)}; }
};

/// By how much ellipses are drawn larger so that the largest can be seen.
double Magnification(const PathShown& path) {
  constexpr double kShare = 0.03;
  double largest = 0;
  for (const auto& [at, cov] : path.covs) {
    largest = std::max(largest, HorizontalEllipse(cov, kConfidence).semi_major);
  }
  Vector3d low = path.points.front(), high = low;
  for (const Vector3d& p : path.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double span = (high - low).maxCoeff();
  if (!(largest > 0) || largest > kShare * span) return 1;
  return RoundTick(kShare * span / largest);
}

/// Some ten stations, the deepest among them.
std::vector<std::size_t> Shown(std::size_t count) {
  std::vector<std::size_t> shown;
  const std::size_t step = std::max<std::size_t>(1, count / 10);
  for (std::size_t back = count; back > 0; back -= std::min(back, step)) shown.push_back(back - 1);
  return shown;
}

void DrawOn(Chart& chart, const PathShown& path, const View& view, double magnify) {
  const double sigmas = ConfidenceFactor(kConfidence, 2);
  for (const std::size_t i : Shown(path.covs.size())) {
    const auto& [at, cov] = path.covs[i];
    const SeenEllipse seen = EllipseSeenAlong(cov, view.right.cross(view.up_or_down), sigmas);
    chart.series.push_back(
        {.name = magnify > 1 ? fmt::format("95 % ellipse, {:g} times as large", magnify)
                             : "95 % ellipse",
         .mark = Mark::kArea,
         .colour = kEllipseColour,
         .points = EllipseOutline(view(path.points[at]), magnify * view(seen.major),
                                  magnify * view(seen.minor))});
  }
  ChartSeries line{.name = path.name, .colour = kSurveyColour, .md = path.md};
  for (const Vector3d& p : path.points) line.points.push_back(view(p));
  chart.series.push_back(std::move(line));
}

void DrawTicks(const PageText& page, Chart& chart, const PathShown& path, const View& view) {
  const double every = RoundTick(std::max(path.md.back() - path.md.front(), 1.0) / 9);
  ChartSeries ticks{.name = page.Named("MD"), .mark = Mark::kDots, .colour = kTickColour};
  double next = every * std::ceil(path.md.front() / every);
  for (std::size_t i = 0; i < path.md.size(); ++i) {
    if (path.md[i] < next) continue;
    ticks.points.push_back(view(path.points[i]));
    ticks.md.push_back(path.md[i]);
    chart.notes.push_back({view(path.points[i]), fmt::format("{:.0f}", path.md[i])});
    next = every * (std::floor(path.md[i] / every) + 1);
  }
  chart.series.push_back(std::move(ticks));
}

void DrawOthers(Chart& chart, const std::vector<PathShown>& others, const View& view) {
  int colour = 2;
  for (const PathShown& other : others) {
    ChartSeries line{.name = Clipped(other.name, 40), .colour = colour++, .md = {}};
    for (const Vector3d& p : other.points) line.points.push_back(view(p));
    chart.series.push_back(std::move(line));
  }
}

std::vector<SpaceSeries> InSpace(const PathShown& path, const std::vector<PathShown>& others,
                                 double magnify) {
  const auto place = [](const Vector3d& p) { return Vector3d(p.y(), p.x(), p.z()); };
  std::vector<SpaceSeries> series;
  const double sigmas = ConfidenceFactor(kConfidence, 2);
  for (const std::size_t i : Shown(path.covs.size())) {
    const auto& [at, cov] = path.covs[i];
    const SeenEllipse seen = EllipseSeenAlong(cov, Vector3d::UnitZ(), sigmas);
    SpaceSeries ring{.mark = Mark::kArea, .colour = kEllipseColour};
    for (const Vector2d& u :
         EllipseOutline(Vector2d::Zero(), Vector2d::UnitX(), Vector2d::UnitY())) {
      ring.points.push_back(
          place(path.points[at] + magnify * (u.x() * seen.major + u.y() * seen.minor)));
    }
    series.push_back(std::move(ring));
  }
  SpaceSeries line{.name = path.name, .colour = kSurveyColour, .md = path.md};
  for (const Vector3d& p : path.points) line.points.push_back(place(p));
  series.push_back(std::move(line));
  int colour = 2;
  for (const PathShown& other : others) {
    SpaceSeries beside{.name = Clipped(other.name, 40), .colour = colour++};
    for (const Vector3d& p : other.points) beside.points.push_back(place(p));
    series.push_back(std::move(beside));
  }
  return series;
}

void AddGrowth(PageText& page, const PathShown& path) {
  Chart chart{.title = "95 % error ellipse along the hole (half axes) and 95 % of TVD",
              .x_name = page.Named("MD"),
              .y_name = page.Named("half axis"),
              .height = 220};
  ChartSeries major{.name = "long half axis", .colour = 1},
      minor{.name = "short half axis", .colour = 0},
      vertical{.name = "TVD \u00b1", .mark = Mark::kDash, .colour = 2};
  for (const auto& [at, cov] : path.covs) {
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

void AddMaps(PageText& page, const PathShown& path, const std::vector<PathShown>& others) {
  const Vector3d reach = path.points.back() - path.points.front();
  const double azimuth = std::atan2(reach.y(), reach.x());
  const View plan{Vector3d::UnitY(), Vector3d::UnitX()};
  const View section{{std::cos(azimuth), std::sin(azimuth), 0}, Vector3d::UnitZ()};
  const double magnify = Magnification(path);
  Chart on_plan{.title = "Plan",
                .x_name = page.Named("east"),
                .y_name = page.Named("north (true)"),
                .equal = true,
                .height = 560};
  Chart on_section{.title = "Vertical section",
                   .x_name = page.Named(
                       fmt::format("along azimuth {:.2f}\u00b0", ToDegrees(WrapTwoPi(azimuth)))),
                   .y_name = page.Named("TVD"),
                   .y_down = true,
                   .equal = true,
                   .height = 560};
  for (const auto& [chart, view] : {std::pair(&on_plan, &plan), std::pair(&on_section, &section)}) {
    DrawOn(*chart, path, *view, magnify);
    DrawOthers(*chart, others, *view);
    DrawTicks(page, *chart, path, *view);
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
  const PathShown path = PathOf(page, At(page.survey, {"stations"}), "survey");
  std::vector<PathShown> others;
  const Json& listed = At(page.survey, {"others"});
  if (listed.is_array()) {
    for (const Json& other : listed) {
      PathShown shown = PathOf(page, other, TextAt(other, {"name"}));
      if (!shown.points.empty()) others.push_back(std::move(shown));
    }
  }
  if (path.points.size() < 2) {
    SayNotMeasured(page, "Path");
  } else {
    AddMaps(page, path, others);
    if (path.covs.empty()) {
      SayNotMeasured(page, "Error ellipses");
    } else {
      AddGrowth(page, path);
    }
  }
  EndBlock(page);
}

}  // namespace wellgyro
