#include "wellgyro/trajectory/path.h"

#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/trajectory/minimum_curvature.h"

namespace wellgyro {
namespace {

// [rad], 56 km from the pole: a hole that goes 10 km aside turns true north by 10 deg there.
constexpr double kLatitudeLimit = FromDegrees(89.5);

bool IsFinite(const PathStation& s) {
  return std::isfinite(s.md) && std::isfinite(s.inclination) && std::isfinite(s.azimuth);
}

Eigen::Vector3d TangentInWell(const Site& head, const PathStation& s, const Eigen::Vector3d& p) {
  return Tangent(s.inclination, s.azimuth - MeridianConvergence(head, p.x(), p.y()));
}

}  // namespace

double MeridianConvergence(const Site& head, double north, double east) {
  const double rise = north / head.radius_north;
  const double middle = head.latitude + 0.5 * rise;
  return east / head.radius_east * std::sin(middle) / std::cos(head.latitude + rise);
}

Path::Path(const Site& head, const PathStation& tie_in, const Eigen::Vector3d& p_WT_W)
    : head_(head) {
  if (!(std::abs(head.latitude) <= kLatitudeLimit)) {
    throw std::invalid_argument(fmt::format(
        "Path: latitude {} deg: true north has no use so near a pole", ToDegrees(head.latitude)));
  }
  if (!IsFinite(tie_in) || !p_WT_W.allFinite()) {
    throw std::invalid_argument("Path: the tie-in has a value that is not finite");
  }
  last_.station = tie_in;
  last_.p_WT_W = p_WT_W;
  last_.tangent_W = TangentInWell(head, tie_in, p_WT_W);
}

Result<PathPoint> Path::Add(const PathStation& station) {
  const double length = station.md - last_.station.md;
  if (!IsFinite(station)) {
    return Fault{.code = FaultCode::kRange,
                 .text = fmt::format("station at {} m has a value that is not finite", station.md)};
  }
  if (!(length > 0)) {
    return Fault{.code = FaultCode::kOrder,
                 .text = fmt::format("station at {} m follows one at {} m: depth must increase",
                                     station.md, last_.station.md)};
  }
  PathPoint next{.station = station, .p_WT_W = last_.p_WT_W};
  // The convergence where the leg ends depends on where it ends. Each pass shrinks the error by
  // half the leg's length over the Earth's radius: after two it is below 1e-7 rad for a leg of a
  // kilometre at 70 deg, and as its square for others.
  for (int pass = 0; pass < 2; ++pass) {
    next.tangent_W = TangentInWell(head_, station, next.p_WT_W);
    const auto leg = MinimumCurvatureLeg(length, last_.tangent_W, next.tangent_W);
    if (!leg) {
      return Fault{
          .code = FaultCode::kRange,
          .text = fmt::format("stations at {} m and {} m point opposite ways, which leaves no arc",
                              last_.station.md, station.md)};
    }
    next.p_WT_W = last_.p_WT_W + leg->displacement;
    next.dogleg_severity = leg->dogleg / length;
  }
  last_ = next;
  return next;
}

PathPoint Interpolate(const Site& head, const PathPoint& from, const PathPoint& to, double md) {
  const double length = md - from.station.md;
  const double fraction = length / (to.station.md - from.station.md);
  PathPoint point{.station = {.md = md}, .dogleg_severity = to.dogleg_severity};
  point.tangent_W = TangentOnArc(from.tangent_W, to.tangent_W, fraction);
  const auto leg = MinimumCurvatureLeg(length, from.tangent_W, point.tangent_W);
  point.p_WT_W = from.p_WT_W + (leg ? leg->displacement : Eigen::Vector3d::Zero());
  const double across = std::hypot(point.tangent_W.x(), point.tangent_W.y());
  point.station.inclination = std::atan2(across, point.tangent_W.z());
  point.station.azimuth = from.station.azimuth;
  if (across > 0) {
    point.station.azimuth =
        WrapTwoPi(std::atan2(point.tangent_W.y(), point.tangent_W.x()) +
                  MeridianConvergence(head, point.p_WT_W.x(), point.p_WT_W.y()));
  }
  return point;
}

}  // namespace wellgyro
