#include "wellgyro/io/coefficients_internal.h"

#include <string>

#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

void ReadOne(TomlTable& table, const std::string& key, double unit, double& value) {
  table.Read(key, value, unit, kNotNegative);
  const bool bounded = table.FindNumber(key + "_upper95", kNotNegative).has_value();
  const bool measured = table.FindNumber(key + "_sigma", kNotNegative).has_value();
  if (bounded && (measured || table.Has(key))) {
    table.Refuse(key + "_upper95", "stands alone, for a coefficient that could not be observed",
                 FaultCode::kConflict);
  }
  if (measured && !table.Has(key)) {
    table.RefuseAbsent(key, "is missing while its sigma is there");
  }
}

}  // namespace

NoiseCoefficients ReadCoefficients(TomlTable& table) {
  NoiseCoefficients c;
  ReadOne(table, "quantization_arcsec", units::kArcsec, c.quantization);
  ReadOne(table, "angle_random_walk_deg_per_sqrt_h", units::kDegPerSqrtHour, c.angle_random_walk);
  ReadOne(table, "bias_instability_deg_per_h", units::kDegPerHour, c.bias_instability);
  ReadOne(table, "rate_random_walk_deg_per_h_sqrt_h", units::kDegPerHourSqrtHour,
          c.rate_random_walk);
  ReadOne(table, "rate_ramp_deg_per_h2", units::kDegPerHour2, c.rate_ramp);
  table.Read("bias_instability_correlation_time_h", c.bias_instability_correlation_time,
             units::kHour, kPositive);
  return c;
}

ErrorPriors ReadPriors(TomlTable& table) {
  ErrorPriors p;
  const auto read = [&](std::string_view key, double& value, double unit) {
    table.Read(key, value, unit, kNotNegative);
  };
  read("gyro_bias_sigma_deg_per_h", p.gyro_bias_sigma, units::kDegPerHour);
  read("mass_unbalance_sigma_deg_per_h_per_g", p.mass_unbalance_sigma, units::kDegPerHourPerG);
  read("quadrature_sigma_deg_per_h_per_g", p.quadrature_sigma, units::kDegPerHourPerG);
  read("gyro_scale_sigma", p.gyro_scale_sigma, 1);
  read("gyro_misalignment_sigma_rad", p.gyro_misalignment_sigma, 1);
  read("accel_bias_sigma_mps2", p.accel_bias_sigma, 1);
  read("accel_noise_mps2_per_sqrt_hz", p.accel_noise, 1);
  read("roll_offset_sigma_deg", p.roll_offset_sigma, units::kDeg);
  read("time_skew_sigma_s", p.time_skew_sigma, 1);
  read("depth_sigma_m", p.depth_sigma, 1);
  read("latitude_sigma_deg", p.latitude_sigma, units::kDeg);
  return p;
}

}  // namespace wellgyro
