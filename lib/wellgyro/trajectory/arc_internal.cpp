#include "wellgyro/trajectory/arc_internal.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/trajectory/minimum_curvature.h"

namespace wellgyro {
namespace {

// Below it a direction has no vertical part: rounding of products of sines, some hundred eps; over
// 10 km it is 1e-9 m.
constexpr double kLevel = 1e-13;
// Rounding at the ends of a leg [m]: 10 km eps = 2e-12 m, many times over.
constexpr double kEnd = 1e-9;

// Arc length from the middle, by v = tan(curvature s / 2) / curvature.
double LengthOf(const Arc& arc, double v) {
  const double x = arc.curvature * v;
  return std::abs(x) < 1e-4 ? 2 * v * (1 - x * x / 3) : 2 * std::atan(x) / arc.curvature;
}

}  // namespace

Arc MakeArc(double length, double begin_z, const Eigen::Vector3d& t1_W,
            const Eigen::Vector3d& t2_W) {
  const Eigen::Vector3d sum = t1_W + t2_W;
  const Eigen::Vector3d difference = t2_W - t1_W;
  const double half = std::atan2(difference.norm(), sum.norm());
  Arc arc;
  arc.length = length;
  arc.curvature = 2 * half / length;
  const Eigen::Vector3d middle = sum / sum.norm();
  arc.along_z = middle.z();
  if (half > 0) arc.across_z = difference.z() / difference.norm();
  const auto to_middle = MinimumCurvatureLeg(0.5 * length, t1_W, middle);
  arc.middle_z = begin_z + (to_middle ? to_middle->displacement.z() : 0);
  return arc;
}

Eigen::Vector2d RangeOf(const Arc& arc, double begin_z, double end_z, double t1_z, double t2_z) {
  Eigen::Vector2d range(std::min(begin_z, end_z), std::max(begin_z, end_z));
  // A leg turns by less than half a circle: it has a highest or lowest point inside exactly when
  // its ends dip in different ways.
  if (t1_z * t2_z < 0) {
    const double v =
        -arc.along_z / (arc.across_z + std::hypot(arc.along_z, arc.across_z)) / arc.curvature;
    const double w =
        -arc.along_z / (arc.across_z - std::hypot(arc.along_z, arc.across_z)) / arc.curvature;
    // z - middle = 2 v (along + across x) / (1 + x^2), x = curvature v.
    for (const double u : {v, w}) {
      const double x = arc.curvature * u;
      if (!(std::abs(x) <= 1)) continue;
      const double z = arc.middle_z + 2 * u * (arc.along_z + arc.across_z * x) / (1 + x * x);
      range = {std::min(range.x(), z), std::max(range.y(), z)};
    }
  }
  return range;
}

Crossings CrossingsAt(const Arc& arc, double z) {
  const double reach = 0.5 * arc.length;
  if (std::abs(arc.along_z) < kLevel && std::abs(arc.across_z) * arc.curvature < kLevel) {
    return {.count = 2, .level = true, .s = {0, arc.length}};
  }
  // z - middle = 2 v (along + across x) / (1 + x^2) with x = curvature v: a quadratic in v.
  const double rise = z - arc.middle_z;
  const double a = arc.curvature * (2 * arc.across_z - arc.curvature * rise);
  const double b = 2 * arc.along_z;
  const double root = std::sqrt(std::max(b * b + 4 * a * rise, 0.0));
  const double q = -0.5 * (b + std::copysign(root, b));
  std::array<double, 2> s{LengthOf(arc, q == 0 ? 0 : -rise / q), 0};
  int count = 1;
  if (a != 0) s[count++] = LengthOf(arc, q / a);
  if (count == 2 && s[0] > s[1]) std::swap(s[0], s[1]);
  Crossings found;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (std::isfinite(s[k]) && std::abs(s[k]) <= reach + kEnd) {
      found.s[static_cast<std::size_t>(found.count++)] = std::clamp(reach + s[k], 0.0, arc.length);
    }
  }
  if (found.count == 0) {
    // It is in the range, so rounding pushed the crossing over an end.
    const bool second = count == 2 && std::abs(s[1]) < std::abs(s[0]);
    const double nearest = second ? s[1] : s[0];
    found.s[0] = nearest < 0 ? 0 : arc.length;
    found.count = 1;
  }
  return found;
}

}  // namespace wellgyro
