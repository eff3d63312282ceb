#include "wellgyro/survey/stations/way.h"

#include <algorithm>
#include <cstddef>

#include "wellgyro/survey/stations/choose.h"
#include "wellgyro/trajectory/minimum_curvature.h"

namespace wellgyro {
namespace {

// [m], between points of a line: nearer than two stations' depths together may be off, directions
// differ by noise.
constexpr double kNearMd = 2 * kSameDepth;
// [m], back from the shallowest point: there another pass begins. More than a string creeps or
// heaves while it rests, less than a joint.
constexpr double kTurn = 1;

std::optional<Eigen::Vector3d> BulgeOf(const Site& head, const PassLine& line, double from,
                                       double to) {
  const auto i = line.Below(from), j = line.Below(to);
  if (!i || !j) return std::nullopt;
  const PathPoint a = Interpolate(head, line.points[*i - 1], line.points[*i], from);
  const PathPoint b = Interpolate(head, line.points[*j - 1], line.points[*j], to);
  const auto leg = MinimumCurvatureLeg(to - from, a.tangent_W, b.tangent_W);
  if (!leg) return std::nullopt;
  return b.p_WT_W - a.p_WT_W - leg->displacement;
}

}  // namespace

std::vector<PathStation> WayBetween(std::span<const Waypoint> way, const Station& above,
                                    const Station& below) {
  const bool down = above.utc <= below.utc;
  const UtcTime first = std::min(above.utc, below.utc), last = std::max(above.utc, below.utc);
  const auto begin = std::ranges::upper_bound(way, first, {}, &Waypoint::utc);
  const auto end = std::ranges::lower_bound(way, last, {}, &Waypoint::utc);
  std::vector<PathStation> between;
  double md = above.md;
  const auto take = [&](const Waypoint& point) {
    if (point.station.md < md + kNearMd || point.station.md > below.md - kNearMd) return;
    between.push_back(point.station);
    md = point.station.md;
  };
  if (begin >= end) return between;
  if (down) {
    std::for_each(begin, end, take);
  } else {
    std::for_each(std::make_reverse_iterator(end), std::make_reverse_iterator(begin), take);
  }
  return between;
}

std::vector<PathStation> WayAbove(std::span<const Waypoint> way, const Station& shallowest,
                                  bool out) {
  std::vector<PathStation> above;
  double md = shallowest.md;
  const auto take = [&](const Waypoint& point) {
    if (point.station.md > md + kTurn) return false;
    if (point.station.md > md - kNearMd) return true;
    above.push_back(point.station);
    md = point.station.md;
    return true;
  };
  if (out) {
    auto next = std::ranges::upper_bound(way, shallowest.utc, {}, &Waypoint::utc);
    while (next != way.end() && take(*next)) ++next;
  } else {
    auto next = std::ranges::lower_bound(way, shallowest.utc, {}, &Waypoint::utc);
    while (next != way.begin() && take(*std::prev(next))) --next;
  }
  std::reverse(above.begin(), above.end());
  return above;
}

std::optional<std::size_t> PassLine::Below(double md) const {
  const auto below =
      std::lower_bound(points.begin(), points.end(), md,
                       [](const PathPoint& p, double x) { return p.station.md < x; });
  if (below == points.end()) return std::nullopt;
  // At the first point itself the first leg serves.
  if (below == points.begin()) {
    return below->station.md == md && points.size() > 1 ? std::optional<std::size_t>(1)
                                                        : std::nullopt;
  }
  return static_cast<std::size_t>(below - points.begin());
}

Eigen::Vector3d Bulge(const Site& head, std::span<const PassLine> lines, const Station& above,
                      const Station& below) {
  const auto of = [](const Station& s) {
    return [&s](const PassLine& line) {
      return line.run == s.run && line.pass_number == s.pass_number;
    };
  };
  for (const Station* s : {&below, &above}) {
    const auto own = std::ranges::find_if(lines, of(*s));
    if (own == lines.end()) continue;
    if (const auto bulge = BulgeOf(head, *own, above.md, below.md)) return *bulge;
  }
  for (const PassLine& line : lines) {
    if (const auto bulge = BulgeOf(head, line, above.md, below.md)) return *bulge;
  }
  return Eigen::Vector3d::Zero();
}

}  // namespace wellgyro
