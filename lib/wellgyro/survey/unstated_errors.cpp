#include "wellgyro/survey/unstated_errors.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

using E = ErrorPriors;
constexpr double kUnbalance = 0.5 * units::kDegPerHourPerG;
constexpr double kMounting = 0.05 * units::kDeg;
constexpr UnstatedError kUnstated[] = {
    {&E::gyro_bias_sigma, 0.1 * units::kDegPerHour},
    {&E::mass_unbalance_sigma, kUnbalance},
    {&E::quadrature_sigma, kUnbalance, &E::mass_unbalance_sigma, 1, "mass unbalance"},
    {&E::gyro_scale_sigma, 1e-3},
    {&E::gyro_misalignment_sigma, kMounting},
    {&E::accel_bias_sigma, 5e-3},
    {&E::accel_scale_sigma, 5e-4, &E::accel_bias_sigma, 1 / units::kStandardGravity,
     "accelerometer bias over 1 g"},
    {&E::accel_misalignment_sigma, kMounting, &E::gyro_misalignment_sigma, 1, "gyro misalignment"},
    {&E::accel_noise, 2e-4},
    {&E::roll_offset_sigma, kMounting, &E::gyro_misalignment_sigma, 1, "gyro misalignment"},
    {&E::time_skew_sigma, 1e-3},
    {&E::depth_sigma, 0.35},
    {&E::depth_scale_sigma, 5.6e-4},
    {&E::latitude_sigma, 0},
};

}  // namespace

std::span<const UnstatedError> UnstatedErrors() { return kUnstated; }

void FillUnstated(std::span<const double* const> stated, ErrorPriors& priors) {
  const auto is_stated = [&](double ErrorPriors::*error) {
    return std::find(stated.begin(), stated.end(), &(priors.*error)) != stated.end();
  };
  for (const UnstatedError& each : kUnstated) {
    if (is_stated(each.error)) continue;
    const bool follows = each.follows != nullptr && is_stated(each.follows);
    // A scale or an angle of more than 1 is no error that is left over.
    priors.*each.error = follows ? std::min(each.ratio * priors.*each.follows, 1.0) : each.value;
  }
}

NoiseCoefficients NoiseUnlessStated() {
  constexpr double kStop = 180;  // [s]
  NoiseCoefficients c;
  c.angle_random_walk = 0.1 * units::kDegPerHour * std::sqrt(kStop);
  c.bias_instability = 0.1 * units::kDegPerHour;
  return c;
}

}  // namespace wellgyro
