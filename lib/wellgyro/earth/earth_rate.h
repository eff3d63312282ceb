#pragma once

#include <cmath>

#include <Eigen/Core>

#include "wellgyro/earth/earth.h"

namespace wellgyro {

/// The Earth's rotation in L, w_IE_L [rad/s].
inline Eigen::Vector3d EarthRateAt(double latitude) {
  return kEarthRate * Eigen::Vector3d(std::cos(latitude), 0, -std::sin(latitude));
}

}  // namespace wellgyro
