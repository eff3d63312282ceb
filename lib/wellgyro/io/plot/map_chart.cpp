#include "wellgyro/io/plot/map_chart.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/plot/plot_text_internal.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Mark = ChartSeries::Mark;

constexpr int kPathColour = 0, kEllipseColour = 1, kFirstOther = 2, kTickColour = 4;

void DrawTicks(Chart& chart, const MapPath& path, const MapView& view, const std::string& unit) {
  const double every = RoundTick(std::max(path.md.back() - path.md.front(), 1.0) / 9);
  ChartSeries ticks{.name = "MD [" + unit + "]", .mark = Mark::kDots, .colour = kTickColour};
  double next = every * std::ceil(path.md.front() / every);
  const ChartFrame frame = FrameOf(chart);
  const double apart = 0.04 * (frame.high - frame.low).maxCoeff();  // of two texts, to be read
  for (std::size_t i = 0; i < path.md.size(); ++i) {
    if (path.md[i] < next) continue;
    ticks.points.push_back(view(path.points_W[i]));
    ticks.md.push_back(path.md[i]);
    const Vector2d at = view(path.points_W[i]);
    if (chart.notes.empty() || (at - chart.notes.back().at).norm() > apart) {
      chart.notes.push_back({at, fmt::format("{:.0f}", path.md[i])});
    }
    next = every * (std::floor(path.md[i] / every) + 1);
  }
  chart.series.push_back(std::move(ticks));
}

}  // namespace

MapSection SectionThrough(const MapPath& path) {
  const Vector3d reach = path.points_W.back() - path.points_W.front();
  const double azimuth = std::atan2(reach.y(), reach.x());
  return {WrapTwoPi(azimuth),
          {Vector3d(std::cos(azimuth), std::sin(azimuth), 0), Vector3d::UnitZ()}};
}

double MagnificationOf(const MapPath& path, double confidence) {
  constexpr double kShare = 0.03;  // of the path's extent, for the largest half axis
  constexpr double kMost = 1000;   // beyond it millimetres are drawn, which no survey has
  double largest = 0;
  for (const auto& [at, cov] : path.covs_W) {
    largest = std::max(largest, HorizontalEllipse(cov, confidence).semi_major);
  }
  Vector3d low = path.points_W.front(), high = low;
  for (const Vector3d& p : path.points_W) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double span = (high - low).maxCoeff();
  if (!(largest > 0) || largest >= kShare * span) return 1;
  return std::clamp(RoundTick(kShare * span / largest), 1.0, kMost);
}

std::vector<std::size_t> EllipsesShown(const MapPath& path) {
  constexpr std::size_t kSome = 10;  // apart by more than three of the largest half axes
  std::vector<std::size_t> shown;
  const std::size_t step = std::max<std::size_t>(1, path.covs_W.size() / kSome);
  for (std::size_t back = path.covs_W.size(); back > 0; back -= std::min(back, step)) {
    shown.push_back(back - 1);
  }
  return shown;
}

void DrawOnMap(Chart& chart, const MapPath& path, const MapView& view, double confidence,
               double magnify, const std::string& unit) {
  const double sigmas = ConfidenceFactor(confidence, 2);
  std::string name = fmt::format("{:g} % ellipse", 100 * confidence);
  if (magnify > 1) name += fmt::format(", {:g} times as large", magnify);
  for (const std::size_t i : EllipsesShown(path)) {
    const auto& [at, cov] = path.covs_W[i];
    const SeenEllipse seen = EllipseSeenAlong(cov, view.right_W.cross(view.other_W), sigmas);
    chart.series.push_back(
        {.name = name,
         .mark = Mark::kArea,
         .colour = kEllipseColour,
         .points = EllipseOutline(view(path.points_W[at]), magnify * view(seen.major),
                                  magnify * view(seen.minor))});
  }
  ChartSeries line{.name = path.name, .colour = kPathColour, .md = path.md};
  for (const Vector3d& p : path.points_W) line.points.push_back(view(p));
  chart.series.push_back(std::move(line));
  DrawTicks(chart, path, view, unit);
}

void DrawBeside(Chart& chart, const MapPath& path, const MapView& view, int number) {
  ChartSeries line{.name = path.name, .colour = kFirstOther + number};
  for (const Vector3d& p : path.points_W) line.points.push_back(view(p));
  chart.series.push_back(std::move(line));
}

}  // namespace wellgyro
