#pragma once

#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "wellgyro/alignment/gyrocompass.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro::test {

inline constexpr double kOmega = 7.292115e-5;  // [rad/s]

/// A tool at rest by the formulas of two transverse axes, not by matrices:
/// W e^{iT} = We (cL cA cI + sL sI) - i We cL sA.
struct ToolAtRest {
  double latitude = 60 * units::kDeg, inclination = 30 * units::kDeg, azimuth = 45 * units::kDeg;
  double seconds = 180;
  double gyro_noise = 0, accel_noise = 0;  ///< of a window's mean
  double bias_x = 0, bias_y = 0, bias_z = 0, m = 0, q = 0;
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  Eigen::Matrix3d accel_linear = Eigen::Matrix3d::Zero();  ///< scales, and axes that lean
  double gyro_roll = 0;  ///< of the gyros against the accelerometers
  bool gz = false;

  Site Place() const { return SiteAt(latitude, 0); }

  StillWindow Window(double toolface, double begin, Random& random) const {
    const double sL = std::sin(latitude), cL = std::cos(latitude);
    const double sI = std::sin(inclination), cI = std::cos(inclination);
    const double sA = std::sin(azimuth), cA = std::cos(azimuth);
    const double g = Place().gravity;
    const auto W = kOmega * std::complex(cL * cA * cI + sL * sI, -cL * sA) *
                   std::polar(1.0, -toolface - gyro_roll);
    const Eigen::Vector3d f(g * sI * std::cos(toolface), -g * sI * std::sin(toolface), -g * cI);
    StillWindow window;
    window.begin = {Duration::Seconds(begin).ns};
    window.end = {Duration::Seconds(begin + seconds).ns};
    window.samples = 100;
    window.has_gz = gz;
    window.w_IT_T = {W.real() + bias_x + m * f.x() + q * f.y(),
                     W.imag() + bias_y + m * f.y() - q * f.x(),
                     gz ? kOmega * (cL * cA * sI - sL * cI) + bias_z : 0};
    window.f_T = f + accel_bias + accel_linear * f;
    for (int i = 0; i < (gz ? 3 : 2); ++i) window.w_IT_T[i] += gyro_noise * random.Normal();
    for (int i = 0; i < 3; ++i) window.f_T[i] += accel_noise * random.Normal();
    window.sigma_w_IT_T = Eigen::Vector3d::Constant(gyro_noise);
    window.sigma_f_T = Eigen::Vector3d::Constant(accel_noise);
    return window;
  }

  std::vector<StillWindow> Windows(std::vector<double> toolfaces, Random& random) const {
    std::vector<StillWindow> windows;
    for (const double toolface : toolfaces) {
      windows.push_back(
          Window(toolface, (seconds + 30) * static_cast<double>(windows.size()), random));
    }
    return windows;
  }
};

/// Of the azimuth [rad].
inline double Sigma(const NorthFix& fix) { return std::sqrt(fix.cov_attitude(1, 1)); }

/// Squared error of all three angles over their covariance: chi-square of three degrees.
inline double Normalised(const NorthFix& fix, const ToolAtRest& truth, double toolface) {
  const Eigen::Vector3d error(fix.inclination - truth.inclination,
                              WrapPi(fix.azimuth - truth.azimuth), WrapPi(fix.toolface - toolface));
  return error.dot(fix.cov_attitude.inverse() * error);
}

/// Chi-square band of `n` draws of `dof` degrees at 99.9 %.
inline void ExpectInBand(double sum, double n, double dof, const std::string& what) {
  EXPECT_GT(sum, ChiSquareQuantile(0.0005, n * dof)) << what << ": " << sum / n / dof;
  EXPECT_LT(sum, ChiSquareQuantile(0.9995, n * dof)) << what << ": " << sum / n / dof;
}

/// Draws a tool's errors by their priors and its place by the latitude's, then its windows.
inline NorthFix Draw(ToolAtRest truth, const ErrorPriors& errors,
                     const std::vector<double>& toolfaces, Random& random) {
  const Site believed = SiteAt(truth.latitude + errors.latitude_sigma * random.Normal(), 0);
  truth.bias_x = errors.gyro_bias_sigma * random.Normal();
  truth.bias_y = errors.gyro_bias_sigma * random.Normal();
  truth.bias_z = errors.gyro_bias_sigma * random.Normal();
  truth.m = errors.mass_unbalance_sigma * random.Normal();
  truth.q = errors.quadrature_sigma * random.Normal();
  for (int i = 0; i < 3; ++i) truth.accel_bias[i] = errors.accel_bias_sigma * random.Normal();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double sigma = i == j ? errors.accel_scale_sigma : errors.accel_misalignment_sigma;
      truth.accel_linear(i, j) = sigma * random.Normal();
    }
  }
  // The frame is the accelerometers', which x and y lean out of alike.
  auto &xy = truth.accel_linear(0, 1), &yx = truth.accel_linear(1, 0);
  truth.gyro_roll = 0.5 * (xy - yx);
  xy = yx = 0.5 * (xy + yx);
  return Gyrocompass(truth.Windows(toolfaces, random), believed, {.errors = errors});
}

}  // namespace wellgyro::test
