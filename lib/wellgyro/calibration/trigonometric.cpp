#include "wellgyro/calibration/trigonometric.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "wellgyro/base/angle.h"
#include "wellgyro/calibration/bench_axes.h"

namespace wellgyro {
namespace {

double Wave(const std::array<double, 4>& x, double angle) {
  return x[0] * std::sin(x[1] * angle + x[2]);
}

void TakeAngles(CorrectedReading& reading) {
  const MagneticAngles angles = AnglesOf(BenchAxes::kTrade, reading.G_B, reading.M_B);
  reading.inclination = angles.inclination;
  reading.toolface = WrapTwoPi(angles.toolface);
}

}  // namespace

Eigen::Matrix<double, 6, 1> TrigonometricErrors(const TrigonometricModel& model, double inclination,
                                                double toolface) {
  Eigen::Matrix<double, 6, 1> errors;
  for (int sensor = 0; sensor < 2; ++sensor) {
    const int first = 3 * sensor;
    const auto k = static_cast<std::size_t>(first);
    errors[first] = Wave(model.x[k], inclination) * std::sin(toolface) + model.x[k][3];
    errors[first + 1] = Wave(model.x[k + 1], inclination) * std::cos(toolface) + model.x[k + 1][3];
    errors[first + 2] = Wave(model.x[k + 2], toolface) * std::sin(inclination) + model.x[k + 2][3];
  }
  return errors;
}

CorrectedReading Correct(const AffineModel& model, const Eigen::Vector3d& G_raw,
                         const Eigen::Vector3d& M_raw) {
  CorrectedReading reading;
  reading.G_B = model.sensitivity_G.inverse() * (G_raw - model.b_G);
  reading.M_B = model.sensitivity_M.inverse() * (M_raw - model.b_M);
  TakeAngles(reading);
  return reading;
}

CorrectedReading Correct(const TrigonometricModel& model, const Eigen::Vector3d& G_raw,
                         const Eigen::Vector3d& M_raw, const AffineModel& affine) {
  // Fixed point: each turn leaves the share (largest error) / sin I of the last one's error, 1/5
  // where it is accepted, 18 turns to kStill [rad]; 200 reach it where the share is 0.87.
  constexpr int kTurnsMost = 200;
  constexpr double kStill = 1e-12;
  const double largest = std::max(std::abs(model.x[0][0]), std::abs(model.x[1][0]));
  CorrectedReading reading;
  reading.G_B = G_raw;
  reading.M_B = M_raw;
  TakeAngles(reading);
  for (reading.turns = 1; reading.turns <= kTurnsMost; ++reading.turns) {
    const double inclination = reading.inclination, toolface = reading.toolface;
    const Eigen::Matrix<double, 6, 1> errors = TrigonometricErrors(model, inclination, toolface);
    reading.G_B = G_raw - errors.head<3>();
    reading.M_B = M_raw - errors.tail<3>();
    TakeAngles(reading);
    if (std::abs(reading.inclination - inclination) > kStill ||
        std::abs(WrapPi(reading.toolface - toolface)) > kStill) {
      continue;
    }
    if (std::sin(reading.inclination) < 5 * largest) break;
    return reading;
  }
  const int turns = std::min(reading.turns, kTurnsMost);
  reading = Correct(affine, G_raw, M_raw);
  reading.turns = turns;
  reading.fell_back = true;
  return reading;
}

TrigonometricModel FromAffine(const AffineModel& affine, double field, double dip) {
  const Eigen::Matrix3d E = affine.sensitivity_G - Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d F = affine.sensitivity_M - Eigen::Matrix3d::Identity();
  const double s = field * std::sin(dip), c = field * std::cos(dip);
  // Parts in phase and at right angles: error = S sin(angle) + C cos(angle) + offset.
  const double parts[6][3] = {
      {-E(0, 0), E(0, 2), affine.b_G[0]},
      {-E(1, 1), E(1, 2), affine.b_G[1]},
      {-E(2, 0), -E(2, 1), affine.b_G[2]},
      {-F(0, 0) * s + F(0, 2) * c, F(0, 0) * c + F(0, 2) * s, affine.b_M[0]},
      {-F(1, 1) * s + F(1, 2) * c, F(1, 1) * c + F(1, 2) * s, affine.b_M[1]},
      {-F(2, 0) * s + F(2, 1) * c, -F(2, 0) * c - F(2, 1) * s, affine.b_M[2]},
  };
  TrigonometricModel model;
  for (std::size_t k = 0; k < 6; ++k) {
    const auto& [in_phase, across, offset] = parts[k];
    model.x[k] = {std::hypot(in_phase, across), 1, std::atan2(across, in_phase), offset};
  }
  return model;
}

}  // namespace wellgyro
