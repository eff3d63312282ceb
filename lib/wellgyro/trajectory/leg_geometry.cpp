#include "wellgyro/trajectory/leg_geometry.h"

#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/math/sinc.h"
#include "wellgyro/trajectory/minimum_curvature.h"

namespace wellgyro {
namespace {

struct Attitude {
  double inclination, azimuth;
};

Eigen::Vector3d Step(SurveyMethod method, double length, const Attitude& a, const Attitude& b) {
  const double turn = WrapPi(b.azimuth - a.azimuth);
  const double build = b.inclination - a.inclination;
  const Attitude mean{a.inclination + 0.5 * build, a.azimuth + 0.5 * turn};
  switch (method) {
    case SurveyMethod::kAverageAngle:
      return length * Tangent(mean.inclination, mean.azimuth);
    case SurveyMethod::kTangential:
      return length * Tangent(b.inclination, b.azimuth);
    case SurveyMethod::kBalancedTangential:
      return 0.5 * length * (Tangent(a.inclination, a.azimuth) + Tangent(b.inclination, b.azimuth));
    default:
      break;
  }
  // (cos I1 - cos I2) (sin A2 - sin A1) / (dI dA) and its fellows, by products of mean and half
  // difference, which have no 0/0.
  const Eigen::Vector3d along = Tangent(mean.inclination, mean.azimuth);
  const double vertical = length * Sinc(0.5 * build);
  const double horizontal = vertical * Sinc(0.5 * turn);
  return {horizontal * along.x(), horizontal * along.y(), vertical * along.z()};
}

[[noreturn]] void RefusePosition(std::size_t station, std::string_view why) {
  throw std::invalid_argument(fmt::format("PositionsBy: station {}: {}", station, why));
}

}  // namespace

LegGeometry GeometryOfLeg(double length, double inclination_1, double azimuth_1,
                          double inclination_2, double azimuth_2) {
  const Eigen::Vector3d t1 = Tangent(inclination_1, azimuth_1);
  const Eigen::Vector3d t2 = Tangent(inclination_2, azimuth_2);
  const auto leg = MinimumCurvatureLeg(length, t1, t2);
  if (!leg || !(length > 0)) {
    throw std::invalid_argument(
        fmt::format("GeometryOfLeg: no arc of {} m from ({}, {}) rad to "
                    "({}, {}) rad",
                    length, inclination_1, azimuth_1, inclination_2, azimuth_2));
  }
  const Eigen::Vector3d high = Tangent(inclination_1 + kPi / 2, azimuth_1);
  const Eigen::Vector3d right(-std::sin(azimuth_1), std::cos(azimuth_1), 0);
  // Differences, not t2 itself: what is across t1 is small and t2's own part along it would
  // drown it.
  const Eigen::Vector3d change = t2 - t1;
  LegGeometry geometry;
  geometry.dogleg = leg->dogleg;
  geometry.dogleg_severity = leg->dogleg / length;
  geometry.build = (inclination_2 - inclination_1) / length;
  geometry.turn = WrapPi(azimuth_2 - azimuth_1) / length;
  if (leg->dogleg > 0) geometry.toolface = std::atan2(change.dot(right), change.dot(high));
  return geometry;
}

Closure ClosureOf(double north, double east) {
  return {std::hypot(north, east), WrapTwoPi(std::atan2(east, north))};
}

double VerticalSection(double north, double east, double azimuth, double north_0, double east_0) {
  return (north - north_0) * std::cos(azimuth) + (east - east_0) * std::sin(azimuth);
}

double TvdSubSea(double tvd, double datum_elevation) { return tvd - datum_elevation; }

void PositionsBy(SurveyMethod method, std::span<const double> md,
                 std::span<const double> inclination, std::span<const double> azimuth,
                 const Eigen::Vector3d& start_W, std::span<Eigen::Vector3d> position_W) {
  if (method == SurveyMethod::kMinimumCurvature) {
    MinimumCurvature(md, inclination, azimuth, start_W, position_W);
    return;
  }
  const std::size_t n = md.size();
  if (inclination.size() != n || azimuth.size() != n || position_W.size() != n) {
    throw std::invalid_argument(
        fmt::format("PositionsBy: {} depths but {} inclinations, {} azimuths, {} positions", n,
                    inclination.size(), azimuth.size(), position_W.size()));
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(md[i]) || !std::isfinite(inclination[i]) || !std::isfinite(azimuth[i])) {
      RefusePosition(i, "a value is not finite");
    }
    if (i == 0) {
      position_W[i] = start_W;
      continue;
    }
    const double length = md[i] - md[i - 1];
    if (!(length > 0)) RefusePosition(i, fmt::format("depth {} m after {} m", md[i], md[i - 1]));
    position_W[i] = position_W[i - 1] + Step(method, length, {inclination[i - 1], azimuth[i - 1]},
                                             {inclination[i], azimuth[i]});
  }
}

}  // namespace wellgyro
