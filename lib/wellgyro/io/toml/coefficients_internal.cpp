#include "wellgyro/io/toml/coefficients_internal.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/error_sources.h"
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
    {"accel_scale_sigma", &ErrorPriors::accel_scale_sigma, 1},
    {"accel_misalignment_sigma_rad", &ErrorPriors::accel_misalignment_sigma, 1},
    {"accel_noise_mps2_per_sqrt_hz", &ErrorPriors::accel_noise, 1},
    {"roll_offset_sigma_deg", &ErrorPriors::roll_offset_sigma, units::kDeg},
    {"time_skew_sigma_s", &ErrorPriors::time_skew_sigma, 1},
    {"depth_sigma_m", &ErrorPriors::depth_sigma, 1},
    {"depth_scale_sigma", &ErrorPriors::depth_scale_sigma, 1},
    {"latitude_sigma_deg", &ErrorPriors::latitude_sigma, units::kDeg},
};

using Member = double ErrorPriors::*;

/// See PriorsOfJob().
void FillUnstated(const std::vector<Member>& stated, ErrorPriors& priors) {
  const auto is_stated = [&](Member member) {
    return std::find(stated.begin(), stated.end(), member) != stated.end();
  };
  const auto fill = [&](Member member, double value) {
    if (!is_stated(member)) priors.*member = value;
  };
  const auto follow = [&](Member member, Member other, double ratio, double value) {
    fill(member, is_stated(other) ? std::min(ratio * priors.*other, 1.0) : value);
  };
  using E = ErrorPriors;
  constexpr double kG = units::kStandardGravity;
  constexpr double kUnbalance = 0.5 * units::kDegPerHourPerG;
  constexpr double kMounting = 0.05 * units::kDeg;
  follow(&E::quadrature_sigma, &E::mass_unbalance_sigma, 1, kUnbalance);
  follow(&E::accel_scale_sigma, &E::accel_bias_sigma, 1 / kG, 5e-4);
  follow(&E::accel_misalignment_sigma, &E::gyro_misalignment_sigma, 1, kMounting);
  follow(&E::roll_offset_sigma, &E::gyro_misalignment_sigma, 1, kMounting);
  fill(&E::gyro_bias_sigma, 0.1 * units::kDegPerHour);
  fill(&E::mass_unbalance_sigma, kUnbalance);
  fill(&E::gyro_scale_sigma, 1e-3);
  fill(&E::gyro_misalignment_sigma, kMounting);
  fill(&E::accel_bias_sigma, 5e-3);
  fill(&E::accel_noise, 2e-4);
  fill(&E::time_skew_sigma, 1e-3);
  fill(&E::depth_sigma, 0.35);
  fill(&E::depth_scale_sigma, 5.6e-4);
}

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

NoiseCoefficients NoiseUnlessStated() {
  constexpr double kStop = 180;  // [s]
  NoiseCoefficients c;
  c.angle_random_walk = 0.1 * units::kDegPerHour * std::sqrt(kStop);
  c.bias_instability = 0.1 * units::kDegPerHour;
  return c;
}

ErrorPriors ReadPriors(TomlTable& table) {
  ErrorPriors priors;
  for (const Prior& prior : kPriors) {
    table.Read(prior.key, priors.*prior.member, prior.unit, JobKeyOf("errors", prior.key).range);
  }
  return priors;
}

std::vector<std::string> PriorsOfNone(const TomlTable& table, const ErrorPriors& priors) {
  std::vector<std::string> none;
  for (const Prior& prior : kPriors) {
    if (table.Has(prior.key) && priors.*prior.member == 0) none.emplace_back(prior.key);
  }
  return none;
}

void WritePriors(TomlWriter& out, const ErrorPriors& priors, std::span<const std::string> none) {
  for (const Prior& prior : kPriors) {
    const bool said = std::find(none.begin(), none.end(), prior.key) != none.end();
    if (priors.*prior.member != 0 || said) {
      out.Number(prior.key, priors.*prior.member / prior.unit);
    }
  }
}

ErrorPriors PriorsOfJob(TomlTable* job, const ToolCalibration* tool) {
  const bool of_tool = tool != nullptr && tool->errors;
  ErrorPriors priors = of_tool ? *tool->errors : ErrorPriors{};
  const ErrorPriors own = job != nullptr ? ReadPriors(*job) : ErrorPriors{};
  std::vector<double ErrorPriors::*> stated;
  for (const Prior& prior : kPriors) {
    const bool by_job = job != nullptr && job->Has(prior.key);
    const bool none = of_tool && std::find(tool->errors_none.begin(), tool->errors_none.end(),
                                           prior.key) != tool->errors_none.end();
    if (by_job) priors.*prior.member = own.*prior.member;
    if (by_job || none || priors.*prior.member != 0) stated.push_back(prior.member);
  }
  FillUnstated(stated, priors);
  if (tool != nullptr) {
    const Eigen::Vector2d known = AxialCoupling(tool->gyro);
    priors.gyro_misalignment_x = known.x();
    priors.gyro_misalignment_y = known.y();
  }
  return priors;
}

}  // namespace wellgyro
