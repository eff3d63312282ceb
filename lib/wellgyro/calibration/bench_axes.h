#pragma once

#include <Eigen/Core>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// What a bench calls x and y; z is down-hole for both.
enum class BenchAxes {
  kTrade,  ///< toolface is measured to y: x = sin T H - cos T R, y = cos T H + sin T R
  kTool,   ///< T of this library, toolface to x: x = cos T H + sin T R, y = -sin T H + cos T R
};

/// Takes vectors from the bench's axes to T.
WELLGYRO_EXPORT Eigen::Matrix3d ToolFromBench(BenchAxes axes);

/// Takes vectors from local level (north, east, down) to the bench's axes.
WELLGYRO_EXPORT Eigen::Matrix3d BenchFromLevel(BenchAxes axes, double inclination, double azimuth,
                                               double toolface);

/// Angles of a tool from gravity `G_B` (pointing down) and field `M_B` in the bench's axes.
struct MagneticAngles {
  double inclination = 0;  ///< [rad]
  double toolface = 0;     ///< [rad]; 0 where the tool is vertical
  double azimuth = 0;      ///< from the field's horizontal part [rad], [0, 2 pi)
};
WELLGYRO_EXPORT MagneticAngles AnglesOf(BenchAxes axes, const Eigen::Vector3d& G_B,
                                        const Eigen::Vector3d& M_B);

}  // namespace wellgyro
