#include "wellgyro/trajectory/minimum_curvature.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include <fmt/core.h>

#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

// tan(kDoglegLimit / 2)^2, beyond which there is no arc.
constexpr double kTangentSquaredLimit = 4e12;

// q / atan(q) by q^2. The next term of the series is below 1e-16 where it is used.
double RatioFactor(double q2) {
  if (q2 < 4e-4) {
    return 1 + q2 * (1.0 / 3 - q2 * (4.0 / 45 - q2 * (44.0 / 945 - q2 * (428.0 / 14175))));
  }
  const double q = std::sqrt(q2);
  return q / std::atan(q);
}

[[noreturn]] void RefuseStation(std::size_t station, std::string_view why) {
  throw std::invalid_argument(fmt::format("MinimumCurvature: station {}: {}", station, why));
}

void CheckSizes(std::size_t n, std::span<const double> inclination, std::span<const double> azimuth,
                std::span<Eigen::Vector3d> position_W, std::span<double> severity,
                std::span<Eigen::Vector3d> tangent_W) {
  if (inclination.size() == n && azimuth.size() == n && position_W.size() == n &&
      (severity.empty() || severity.size() == n) && (tangent_W.empty() || tangent_W.size() == n)) {
    return;
  }
  throw std::invalid_argument(fmt::format(
      "MinimumCurvature: {} depths but {} inclinations, {} azimuths, {} positions, {} "
      "severities, {} tangents",
      n, inclination.size(), azimuth.size(), position_W.size(), severity.size(), tangent_W.size()));
}

}  // namespace

std::optional<ArcLeg> MinimumCurvatureLeg(double length, const Eigen::Vector3d& t1,
                                          const Eigen::Vector3d& t2) {
  const Eigen::Vector3d sum = t1 + t2;
  const double q2 = (t2 - t1).squaredNorm() / sum.squaredNorm();
  // Written so that what is not a number is refused too.
  if (!(q2 < kTangentSquaredLimit) || !std::isfinite(length)) return std::nullopt;
  const double factor = RatioFactor(q2);
  return ArcLeg{.displacement = 0.5 * length * factor * sum, .dogleg = 2 * std::sqrt(q2) / factor};
}

Eigen::Vector3d TangentOnArc(const Eigen::Vector3d& t1, const Eigen::Vector3d& t2,
                             double fraction) {
  const Eigen::Vector3d sum = t1 + t2;
  const Eigen::Vector3d difference = t2 - t1;
  const double half = std::atan2(difference.norm(), sum.norm());
  // From the middle of the arc: cos along the sum, sin along the difference, each divided by that
  // vector's length, 2 cos(half) and 2 sin(half).
  const double from_middle = (2 * fraction - 1) * half;
  const double along_sum = 0.5 * std::cos(from_middle) / std::cos(half);
  const double along_difference =
      half > 1e-9 ? 0.5 * std::sin(from_middle) / std::sin(half) : fraction - 0.5;
  return along_sum * sum + along_difference * difference;
}

void MinimumCurvature(std::span<const double> md, std::span<const double> inclination,
                      std::span<const double> azimuth, const Eigen::Vector3d& start_W,
                      std::span<Eigen::Vector3d> position_W, std::span<double> severity,
                      std::span<Eigen::Vector3d> tangent_W) {
  CheckSizes(md.size(), inclination, azimuth, position_W, severity, tangent_W);
  if (!start_W.allFinite()) RefuseStation(0, "its position is not finite");
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  Eigen::Vector3d at = start_W;
  for (std::size_t i = 0; i < md.size(); ++i) {
    const Eigen::Vector3d next = Tangent(inclination[i], azimuth[i]);
    if (!std::isfinite(md[i]) || !next.allFinite()) RefuseStation(i, "a value is not finite");
    double dls = 0;
    if (i > 0) {
      const double length = md[i] - md[i - 1];
      if (!(length > 0 && length <= std::numeric_limits<double>::max())) {
        RefuseStation(i, fmt::format("depth {} m after {} m", md[i], md[i - 1]));
      }
      const std::optional<ArcLeg> leg = MinimumCurvatureLeg(length, before, next);
      if (!leg) {
        RefuseStation(
            i, fmt::format("at depth {} m it points opposite to the one before, which leaves "
                           "no arc",
                           md[i]));
      }
      at += leg->displacement;
      dls = leg->dogleg / length;
    }
    before = next;
    position_W[i] = at;
    if (!tangent_W.empty()) tangent_W[i] = next;
    if (!severity.empty()) severity[i] = dls;
  }
}

}  // namespace wellgyro
