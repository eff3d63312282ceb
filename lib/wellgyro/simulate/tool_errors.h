#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/simulate/rate_noise.h"
#include "wellgyro/simulate/simulation.h"
#include "wellgyro/simulate/truth.h"

namespace wellgyro {

/// One tool out of many: every error drawn from its 1-sigma prior, each from its own stream of
/// `seed`, the noise as given. `priors.latitude_sigma` is the job's error, not the tool's, and is
/// left to the job.
WELLGYRO_EXPORT ToolErrors DrawToolErrors(const ErrorPriors& priors, const NoiseCoefficients& noise,
                                          std::uint64_t seed);

/// Rounds what has accumulated since the begin to whole steps, as a counter of pulses does.
class WELLGYRO_EXPORT Quantizer {
 public:
  /// `step` zero: nothing is rounded.
  explicit Quantizer(double step) : step_(step) {}
  double Mean(double mean, double seconds);

 private:
  double step_;
  double rest_ = 0;
};

/// What the errors of a tool make of true means. Keeps the state of its noises: one call a sample.
class WELLGYRO_EXPORT SensorErrors {
 public:
  SensorErrors(const SimulatedTool& tool, std::uint64_t seed);

  /// Fills rate, specific force and field of the sample over [begin, end] and its saturation flags.
  void Measure(const Truth& truth, double begin, double end, ImuSample& sample);
  /// From now on, but for the gyros' noise and the steps to which sensors round.
  void SetErrors(const ToolErrors& errors) { tool_.errors = errors; }

 private:
  Eigen::Vector3d Rate(const SensorTruth& truth, double seconds, bool& saturated);
  Eigen::Vector3d Force(const Eigen::Vector3d& f_T, double seconds, bool& saturated);

  SimulatedTool tool_;
  std::array<RateNoise, 3> gyro_noise_;
  std::array<Random, 3> accel_noise_;
  Random mag_noise_;
  std::array<Quantizer, 3> gyro_quantizer_;
  std::array<Quantizer, 3> accel_quantizer_;
};

}  // namespace wellgyro
