#include "wellgyro/calibration/bench_axes.h"

#include <cmath>

#include <Eigen/Geometry>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {

Eigen::Matrix3d ToolFromBench(BenchAxes axes) {
  if (axes == BenchAxes::kTool) return Eigen::Matrix3d::Identity();
  Eigen::Matrix3d R;
  R << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  return R;
}

Eigen::Matrix3d BenchFromLevel(BenchAxes axes, double inclination, double azimuth,
                               double toolface) {
  // What is at right angles is so to the last digit: rounding shall not pass for a signal, 45 eps
  // of products of two rotations.
  constexpr double kRounding = 1e-14;
  const Eigen::Matrix3d R =
      (AttitudeMatrix(azimuth, inclination, toolface) * ToolFromBench(axes)).transpose();
  return (R.array().abs() < kRounding).select(0, R);
}

MagneticAngles AnglesOf(BenchAxes axes, const Eigen::Vector3d& G_B, const Eigen::Vector3d& M_B) {
  const Eigen::Matrix3d R_TB = ToolFromBench(axes);
  const Eigen::Vector3d g = R_TB * G_B, m = R_TB * M_B;
  MagneticAngles angles;
  const double across = std::hypot(g.x(), g.y());
  angles.inclination = std::atan2(across, g.z());
  if (across > 0) angles.toolface = std::atan2(g.y(), -g.x());
  // East and north in the tool, both times the same length: down x field, and that x down.
  const Eigen::Vector3d down = g.normalized();
  const Eigen::Vector3d east = down.cross(m), north = east.cross(down);
  angles.azimuth = WrapTwoPi(std::atan2(east.z(), north.z()));
  return angles;
}

}  // namespace wellgyro
