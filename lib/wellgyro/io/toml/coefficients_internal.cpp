#include "wellgyro/io/toml/coefficients_internal.h"

#include <string>

#include "wellgyro/base/units.h"
#include "wellgyro/survey/job_keys.h"

namespace wellgyro {
namespace {

struct Prior {
  std::string_view key;
  double ErrorPriors::*member;
  double unit;
};

constexpr Prior kPriors[] = {
    {"gyro_bias_sigma_deg_per_h", &ErrorPriors::gyro_bias_sigma, units::kDegPerHour},
    {"mass_unbalance_sigma_deg_per_h_per_g", &ErrorPriors::mass_unbalance_sigma,
     units::kDegPerHourPerG},
    {"quadrature_sigma_deg_per_h_per_g", &ErrorPriors::quadrature_sigma, units::kDegPerHourPerG},
    {"gyro_scale_sigma", &ErrorPriors::gyro_scale_sigma, 1},
    {"gyro_misalignment_sigma_rad", &ErrorPriors::gyro_misalignment_sigma, 1},
    {"accel_bias_sigma_mps2", &ErrorPriors::accel_bias_sigma, 1},
    {"accel_noise_mps2_per_sqrt_hz", &ErrorPriors::accel_noise, 1},
    {"roll_offset_sigma_deg", &ErrorPriors::roll_offset_sigma, units::kDeg},
    {"time_skew_sigma_s", &ErrorPriors::time_skew_sigma, 1},
    {"depth_sigma_m", &ErrorPriors::depth_sigma, 1},
    {"latitude_sigma_deg", &ErrorPriors::latitude_sigma, units::kDeg},
};

void ReadOne(TomlTable& table, const std::string& key, double unit, double& value) {
  table.Read(key, value, unit, JobKeyOf("noise", key).range);
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
             units::kHour, JobKeyOf("noise", "bias_instability_correlation_time_h").range);
  return c;
}

ErrorPriors ReadPriors(TomlTable& table) {
  ErrorPriors priors;
  for (const Prior& prior : kPriors) {
    table.Read(prior.key, priors.*prior.member, prior.unit, JobKeyOf("errors", prior.key).range);
  }
  return priors;
}

void WritePriors(TomlWriter& out, const ErrorPriors& priors) {
  for (const Prior& prior : kPriors) {
    if (priors.*prior.member != 0) out.Number(prior.key, priors.*prior.member / prior.unit);
  }
}

}  // namespace wellgyro
