#include "wellgyro/record/force_errors.h"

#include <cmath>

namespace wellgyro {

double ShearSigma(const ErrorPriors& errors) {
  return errors.accel_misalignment_sigma / std::sqrt(2.0);
}

double ToolfaceOffsetSigma(const ErrorPriors& errors) {
  return std::hypot(errors.roll_offset_sigma, ShearSigma(errors));
}

Eigen::Matrix<double, 3, kForceErrors> ForceErrors(const ErrorPriors& errors,
                                                   const Eigen::Vector3d& f) {
  const double lean = errors.accel_misalignment_sigma;
  Eigen::Matrix<double, 3, kForceErrors> by;
  by.leftCols<3>() = errors.accel_bias_sigma * Eigen::Matrix3d::Identity();
  by.middleCols<3>(3) = errors.accel_scale_sigma * Eigen::Matrix3d(f.asDiagonal());
  by.col(6) = lean * f.z() * Eigen::Vector3d::UnitX();
  by.col(7) = lean * f.z() * Eigen::Vector3d::UnitY();
  by.col(8) = lean * f.x() * Eigen::Vector3d::UnitZ();
  by.col(9) = lean * f.y() * Eigen::Vector3d::UnitZ();
  by.col(10) = ShearSigma(errors) * Eigen::Vector3d(f.y(), f.x(), 0);
  return by;
}

}  // namespace wellgyro
