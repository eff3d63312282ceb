#include "wellgyro/alignment/magnetic.h"

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "wellgyro/base/angle.h"

namespace wellgyro {

std::optional<double> MagneticAzimuth(std::span<const StillWindow> windows) {
  // Of a direction, less than which none is left in the level: 0.2 arcsec, that no sensor tells.
  constexpr double kLevel = 1e-6;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const StillWindow& window : windows) {
    if (!window.has_mag) continue;
    const Eigen::Vector3d down = -window.f_T.normalized();
    const Eigen::Vector3d north = window.b_T - window.b_T.dot(down) * down;
    const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ() - down.z() * down;
    const bool level = north.norm() > kLevel * window.b_T.norm() && axis.norm() > kLevel;
    if (!(window.f_T.norm() > 0) || !level) continue;
    const Eigen::Vector2d towards(north.dot(axis), down.dot(north.cross(axis)));
    sum += towards.normalized();
  }
  if (!(sum.norm() > 0)) return std::nullopt;
  return WrapTwoPi(std::atan2(sum.y(), sum.x()));
}

}  // namespace wellgyro
