#include "wellgyro/page/space_internal.h"

#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Of the view that is printed: north to the left of the depth, all three axes apart on the paper.
constexpr double kTurnDeg = -35, kTiltDeg = 25;

/// Seen from a distance: right and up on the paper.
Vector2d Seen(const Vector3d& p) {
  const double turn = FromDegrees(kTurnDeg), tilt = FromDegrees(kTiltDeg);
  const double right = std::cos(turn) * p.x() + std::sin(turn) * p.y();
  const double away = -std::sin(turn) * p.x() + std::cos(turn) * p.y();
  return {right, std::sin(tilt) * away - std::cos(tilt) * p.z()};
}

struct Box {
  Vector3d low = Vector3d::Constant(1e300), high = Vector3d::Constant(-1e300);
};

Box BoxOf(const std::vector<SpaceSeries>& series) {
  Box box;
  for (const SpaceSeries& one : series) {
    for (const Vector3d& p : one.points) {
      box.low = box.low.cwiseMin(p);
      box.high = box.high.cwiseMax(p);
    }
  }
  return box;
}

/// The twelve edges of the box: pairs of corners that part in one coordinate.
void AddEdges(const Box& box, std::vector<SpaceSeries>& series) {
  const auto corner = [&](int bits) {
    return Vector3d((bits & 1) != 0 ? box.high.x() : box.low.x(),
                    (bits & 2) != 0 ? box.high.y() : box.low.y(),
                    (bits & 4) != 0 ? box.high.z() : box.low.z());
  };
  for (int from = 0; from < 8; ++from) {
    for (const int bit : {1, 2, 4}) {
      if ((from & bit) == 0) {
        series.push_back({.mark = ChartSeries::Mark::kDash,
                          .colour = kHelpColour,
                          .points = {corner(from), corner(from | bit)}});
      }
    }
  }
}

struct SpaceNote {
  Vector3d at;
  std::string text;
};

std::vector<SpaceNote> SidesOf(const PageText& page, const Box& box) {
  const auto range = [&](const char* name, int axis) {
    return fmt::format("{} {:.0f} to {:.0f} {}", name, box.low(axis), box.high(axis),
                       page.units.length_name);
  };
  const Vector3d middle = (box.low + box.high) / 2;
  return {{{middle.x(), box.low.y(), box.high.z()}, range("east", 0)},
          {{box.high.x(), middle.y(), box.high.z()}, range("north", 1)},
          {{box.high.x(), box.low.y(), middle.z()}, range("TVD", 2)}};
}

Json PointsJson(const std::vector<Vector3d>& points) {
  Json list = Json::array();
  for (const Vector3d& p : points) {
    for (const double v : {p.x(), p.y(), p.z()}) list.push_back(std::round(v * 100) / 100);
  }
  return list;
}

}  // namespace

void AddSpace(PageText& page, std::string_view id, const std::string& title,
              std::vector<SpaceSeries> series) {
  const Box box = BoxOf(series);
  AddEdges(box, series);
  Chart chart{.title = title, .equal = true, .axes = false, .width = 720, .height = 460};
  Json space = Json::array();
  for (SpaceSeries& one : series) {
    ChartSeries flat{.name = one.name, .mark = one.mark, .colour = one.colour, .md = one.md};
    for (const Vector3d& p : one.points) flat.points.push_back(Seen(p));
    chart.series.push_back(std::move(flat));
    space.push_back(PointsJson(one.points));
  }
  Json notes = Json::array();
  for (const SpaceNote& note : SidesOf(page, box)) {
    chart.notes.push_back({Seen(note.at), note.text});
    notes.push_back(PointsJson({note.at}));
  }
  AddChart(page, id, chart, false);
  page.charts.back()["space"] = {
      {"turn_deg", kTurnDeg}, {"tilt_deg", kTiltDeg}, {"points", space}, {"notes", notes}};
}

}  // namespace wellgyro
