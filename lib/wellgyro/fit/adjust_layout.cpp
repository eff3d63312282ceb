#include <cmath>
#include <vector>

#include "wellgyro/fit/adjust_layout_internal.h"
#include "wellgyro/math/drift.h"
#include "wellgyro/record/knot_sources.h"

namespace wellgyro {

AdjustLayout AdjustLayoutOf(const FilterSetup& setup, double sigma_lie, bool repeats) {
  AdjustLayout layout;
  const NoiseCoefficients& gyro = setup.gyro;
  const bool markov = gyro.bias_instability_correlation_time && gyro.bias_instability > 0;
  const double constant =
      std::hypot(setup.errors.gyro_bias_sigma, markov ? 0 : gyro.bias_instability);
  const bool walks = gyro.rate_random_walk > 0 || gyro.rate_ramp > 0;
  layout.level_sigma = constant;
  layout.level_walk = gyro.rate_random_walk;
  if (markov) {
    layout.markov_sigma = kMarkovSigmaPerInstability * gyro.bias_instability;
    layout.markov_seconds = *gyro.bias_instability_correlation_time;
  }

  std::vector<double> sigmas;
  const auto common = [&](double sigma) {
    if (!(sigma > 0)) return -1;
    sigmas.push_back(sigma);
    return static_cast<int>(sigmas.size()) - 1;
  };
  for (auto& axis : layout.axis) {
    if (walks) {
      axis.level = layout.node++;
    } else {
      axis.level_common = common(constant);
    }
    if (markov) axis.markov = layout.node++;
    axis.ramp_common = common(gyro.rate_ramp);
  }
  const Knot::SourceVector sigma = SourceSigmas(setup.errors);
  for (int i = 0; i < Knot::kSources; ++i) {
    layout.source[static_cast<std::size_t>(i)] = common(sigma[i]);
  }
  layout.latitude = common(setup.errors.latitude_sigma);
  if (repeats) {
    layout.lie_azimuth = common(std::sqrt(2.0) * sigma_lie);
    layout.lie_inclination = common(std::sqrt(2.0) * sigma_lie);
  }
  if (sigmas.empty()) {
    layout.dummy = true;
    sigmas.push_back(1);
  }
  layout.common = static_cast<int>(sigmas.size());
  layout.sigma_common = Eigen::Map<const Eigen::VectorXd>(sigmas.data(), layout.common);
  return layout;
}

}  // namespace wellgyro
