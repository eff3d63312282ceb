#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/uncertainty/hole_arc_internal.h"

namespace wellgyro {

using Eigen::Vector3d;

HoleArc::HoleArc(const SurveyPoint& from, const SurveyPoint& to)
    : length_(to.md - from.md),
      from_W_(wellgyro::Tangent(from.inclination, from.azimuth)),
      side_W_(Vector3d::Zero()) {
  const Vector3d end = wellgyro::Tangent(to.inclination, to.azimuth);
  const Vector3d across = end - from_W_.dot(end) * from_W_;
  if (across.norm() < 1e-12) return;
  side_W_ = across.normalized();
  curvature_ = std::atan2(across.norm(), from_W_.dot(end)) / length_;
}

Vector3d HoleArc::Tangent(double s) const {
  const double x = curvature_ * s;
  return std::cos(x) * from_W_ + std::sin(x) * side_W_;
}

Vector3d HoleArc::Bend(double s) const {
  const double x = curvature_ * s;
  return curvature_ * (std::cos(x) * side_W_ - std::sin(x) * from_W_);
}

void HoleArc::Crossings(double inclination, std::vector<double>& places) const {
  if (curvature_ == 0) return;
  // from.z cos x + side.z sin x = reach cos(x - peak)
  const double reach = std::hypot(from_W_.z(), side_W_.z());
  const double wanted = std::cos(inclination);
  if (std::abs(wanted) >= reach) return;
  const double peak = std::atan2(side_W_.z(), from_W_.z());
  const double away = std::atan2(std::sqrt(reach * reach - wanted * wanted), wanted);
  double found[] = {WrapTwoPi(peak - away) / curvature_, WrapTwoPi(peak + away) / curvature_};
  if (found[0] > found[1]) std::swap(found[0], found[1]);
  for (const double s : found) {
    if (s > 0 && s < length_) places.push_back(s);
  }
}

}  // namespace wellgyro
