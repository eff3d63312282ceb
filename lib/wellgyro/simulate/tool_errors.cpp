#include "wellgyro/simulate/tool_errors.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/simulate/random_stream.h"

namespace wellgyro {
namespace {

// Streams of the simulation's seed; those of the gyros' noises lie below 3 * 32.
enum ToolStream : std::uint64_t { kAccelNoise = 1000, kMagNoise = 1010, kDrawnErrors = 2000 };

double Clip(double value, double full_scale, bool& saturated) {
  if (full_scale <= 0 || std::abs(value) < full_scale) return value;
  saturated = true;
  return std::copysign(full_scale, value);
}

}  // namespace

ToolErrors DrawToolErrors(const ErrorPriors& priors, const NoiseCoefficients& noise,
                          std::uint64_t seed) {
  std::uint64_t stream = kDrawnErrors;
  const auto draw = [&](double sigma) { return sigma * RandomStream(seed, stream++).Normal(); };
  ToolErrors errors;
  for (double& bias : errors.gyro_bias) bias = draw(priors.gyro_bias_sigma);
  for (double& scale : errors.gyro_scale) scale = draw(priors.gyro_scale_sigma);
  for (double& angle : errors.gyro_misalignment) angle = draw(priors.gyro_misalignment_sigma);
  errors.mass_unbalance = draw(priors.mass_unbalance_sigma);
  errors.quadrature = draw(priors.quadrature_sigma);
  for (double& bias : errors.accel_bias) bias = draw(priors.accel_bias_sigma);
  errors.roll_offset = draw(priors.roll_offset_sigma);
  errors.time_skew = draw(priors.time_skew_sigma);
  errors.depth_offset = draw(priors.depth_sigma);
  errors.depth_scale = draw(priors.depth_scale_sigma);
  for (double& scale : errors.accel_scale) scale = draw(priors.accel_scale_sigma);
  for (int axis = 0; axis < 3; ++axis) {
    for (const int other : {(axis + 1) % 3, (axis + 2) % 3}) {
      errors.accel_misalignment(axis, other) = draw(priors.accel_misalignment_sigma);
    }
  }
  errors.gyro_noise = noise;
  errors.accel_noise = priors.accel_noise;
  return errors;
}

double Quantizer::Mean(double mean, double seconds) {
  if (step_ <= 0) return mean;
  rest_ += mean * seconds;
  const double counted = std::nearbyint(rest_ / step_) * step_;
  rest_ -= counted;
  return counted / seconds;
}

SensorErrors::SensorErrors(const SimulatedTool& tool, std::uint64_t seed)
    : tool_(tool),
      gyro_noise_{RateNoise(tool.errors.gyro_noise, tool.errors.flicker, seed, 0),
                  RateNoise(tool.errors.gyro_noise, tool.errors.flicker, seed, 1),
                  RateNoise(tool.errors.gyro_noise, tool.errors.flicker, seed, 2)},
      accel_noise_{RandomStream(seed, kAccelNoise), RandomStream(seed, kAccelNoise + 1),
                   RandomStream(seed, kAccelNoise + 2)},
      mag_noise_(RandomStream(seed, kMagNoise)),
      // Rounding to steps of d has the Allan variance of Q = d / sqrt(12).
      gyro_quantizer_{Quantizer(std::sqrt(12.0) * tool.errors.gyro_noise.quantization),
                      Quantizer(std::sqrt(12.0) * tool.errors.gyro_noise.quantization),
                      Quantizer(std::sqrt(12.0) * tool.errors.gyro_noise.quantization)},
      accel_quantizer_{Quantizer(tool.errors.accel_quantization),
                       Quantizer(tool.errors.accel_quantization),
                       Quantizer(tool.errors.accel_quantization)} {}

Eigen::Vector3d SensorErrors::Rate(const SensorTruth& truth, double seconds, bool& saturated) {
  const ToolErrors& e = tool_.errors;
  const Eigen::Vector3d& f = truth.f_T;
  Eigen::Vector3d rate = truth.w_IT_T;
  rate.head<2>() += e.gyro_misalignment * truth.w_IT_T.z();
  rate += e.gyro_scale.cwiseProduct(rate) + e.gyro_bias;
  rate.x() += e.mass_unbalance * f.x() + e.quadrature * f.y();
  rate.y() += e.mass_unbalance * f.y() - e.quadrature * f.x();
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    rate[i] += gyro_noise_[axis].Mean(seconds);
    if (i == 2 && !tool_.has_gz) continue;
    rate[i] = Clip(rate[i], e.gyro_full_scale, saturated);
    rate[i] = gyro_quantizer_[axis].Mean(rate[i], seconds);
  }
  if (!tool_.has_gz) rate.z() = 0;
  return rate;
}

Eigen::Vector3d SensorErrors::Force(const Eigen::Vector3d& f_T, double seconds, bool& saturated) {
  const ToolErrors& e = tool_.errors;
  Eigen::Vector3d f = f_T;
  if (e.roll_offset != 0) {
    const double c = std::cos(e.roll_offset), s = std::sin(e.roll_offset);
    f = {c * f_T.x() + s * f_T.y(), c * f_T.y() - s * f_T.x(), f_T.z()};
  }
  const Eigen::Vector3d leaning = e.accel_misalignment * f;
  f += e.accel_scale.cwiseProduct(f) + leaning + e.accel_bias;
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    if (e.accel_noise != 0) {
      f[i] += e.accel_noise / std::sqrt(seconds) * accel_noise_[axis].Normal();
    }
    f[i] = Clip(f[i], e.accel_full_scale, saturated);
    f[i] = accel_quantizer_[axis].Mean(f[i], seconds);
  }
  return f;
}

void SensorErrors::Measure(const Truth& truth, double begin, double end, ImuSample& sample) {
  const ToolErrors& e = tool_.errors;
  const double seconds = end - begin;
  const SensorTruth mean = truth.MeanOver(begin, end);
  const bool apart = e.time_skew != 0 || e.accel_lever_arm_T != Eigen::Vector3d::Zero();
  const Eigen::Vector3d f_T =
      apart ? truth.MeanOver(begin + e.time_skew, end + e.time_skew, e.accel_lever_arm_T).f_T
            : mean.f_T;
  sample.stamp.gyro_saturated = false;
  sample.stamp.accel_saturated = false;
  sample.w_IT_T = Rate(mean, seconds, sample.stamp.gyro_saturated);
  sample.f_T = Force(f_T, seconds, sample.stamp.accel_saturated);
  sample.has_gz = tool_.has_gz;
  sample.has_mag = tool_.has_mag;
  sample.b_T.setZero();
  if (!tool_.has_mag) return;
  sample.b_T = mean.b_T;
  if (e.mag_noise == 0) return;
  for (double& axis : sample.b_T) axis += e.mag_noise * mag_noise_.Normal();
}

}  // namespace wellgyro
