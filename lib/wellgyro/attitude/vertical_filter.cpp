#include "wellgyro/attitude/vertical_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "wellgyro/attitude/vertical_core_internal.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

using vertical::Core;
using vertical::Noise;
using vertical::SensedOf;

constexpr std::array<double, 5> kWalks = {1e-5, 1e-4, 1e-3, 1e-2, 1e-1};  // [rad/s/sqrt(s)]
constexpr double kBlockSeconds = 0.2;
constexpr double kLeastWeight = 1e-4;
constexpr double kPatience = 3;  // that long without weight, then start again from the best [s]
constexpr double kFlat = kPi * kPi / 3;

Knot::SourceVector SourceSigmas(const ErrorPriors& e) {
  Knot::SourceVector sigma;
  sigma << 0, 0, e.mass_unbalance_sigma, e.quadrature_sigma, e.gyro_scale_sigma, e.gyro_scale_sigma,
      e.gyro_misalignment_sigma, e.gyro_misalignment_sigma, e.roll_offset_sigma, e.time_skew_sigma,
      e.accel_bias_sigma, e.accel_bias_sigma, e.accel_bias_sigma;
  return sigma;
}

bool IsFinite(const ImuSample& s) {
  return s.w_IT_T.head<2>().allFinite() && s.f_T.allFinite() &&
         (!s.has_gz || std::isfinite(s.w_IT_T.z()));
}

}  // namespace

struct VerticalFilter::Impl {
  explicit Impl(const VerticalSetup& s);
  void Start(const ImuSample& sample, const AlongHole& along, const Site& site);
  void Close();
  void Weigh(const std::array<double, kWalks.size()>& likelihood, double seconds);
  Noise NoiseOf(double walk) const;
  Eigen::Matrix3d CovTurn() const;

  VerticalSetup setup;
  Noise noise;
  double bias_sigma = 0;
  Knot::SourceVector source_sigma;
  Core main;
  std::array<Core, kWalks.size()> bank;
  std::array<double, kWalks.size()> weight{};
  std::array<double, kWalks.size()> idle{};  // how long without weight [s]
  bool started = false, ready = false;
  ToolTime end;
  std::int64_t seq = 0;
  std::int32_t session = 0;
};

VerticalFilter::Impl::Impl(const VerticalSetup& s) : setup(s) {
  const NoiseCoefficients& g = s.gyro;
  noise.rate = g.angle_random_walk;
  noise.force = s.errors.accel_noise;
  noise.bias_walk = g.rate_random_walk;
  double instability = g.bias_instability;
  if (g.bias_instability_correlation_time) {
    instability *= 1.075;
    noise.bias_walk = std::hypot(noise.bias_walk,
                                 instability * std::sqrt(2 / *g.bias_instability_correlation_time));
  }
  noise.skewed = std::hypot(s.errors.gyro_misalignment_sigma, s.errors.gyro_scale_sigma);
  bias_sigma = std::hypot(s.errors.gyro_bias_sigma, instability);
  source_sigma = SourceSigmas(s.errors);
  source_sigma[Knot::kGyroBiasX] = source_sigma[Knot::kGyroBiasY] = bias_sigma;
}

Noise VerticalFilter::Impl::NoiseOf(double walk) const {
  Noise n = noise;
  n.axial_walk = walk;
  return n;
}

// The gains rest on what the filter models; what all errors do with these gains is known better.
Eigen::Matrix3d VerticalFilter::Impl::CovTurn() const {
  const auto slopes = main.sources().topRows<3>();
  return main.cov_noise().topLeftCorner<3, 3>() +
         slopes * source_sigma.cwiseAbs2().asDiagonal() * slopes.transpose();
}

void VerticalFilter::Impl::Start(const ImuSample& sample, const AlongHole& along,
                                 const Site& site) {
  const Eigen::Vector3d& f = sample.f_T;
  const Eigen::Matrix3d R_LT =
      AttitudeMatrix(0, std::atan2(std::hypot(f.x(), f.y()), -f.z()), std::atan2(-f.y(), f.x()));
  main.Start(SensedOf(sample, along, site, R_LT), R_LT, noise, setup.errors, bias_sigma);
  bank.fill(main);
  weight.fill(1.0 / kWalks.size());
  idle.fill(0);
  started = true;
  ready = false;
}

void VerticalFilter::Impl::Weigh(const std::array<double, kWalks.size()>& likelihood,
                                 double seconds) {
  const double best = *std::max_element(likelihood.begin(), likelihood.end());
  double sum = 0;
  for (std::size_t i = 0; i < kWalks.size(); ++i) {
    weight[i] *= std::exp(likelihood[i] - best);
    sum += weight[i];
  }
  for (std::size_t i = 0; i < kWalks.size(); ++i) {
    const bool without = weight[i] <= kLeastWeight * sum;
    weight[i] = std::max(weight[i] / sum, kLeastWeight);
    idle[i] = without ? idle[i] + seconds : 0;
    if (idle[i] > kPatience) {
      bank[i] = main;
      idle[i] = 0;
    }
  }
}

void VerticalFilter::Impl::Close() {
  const double seconds = main.block_seconds();
  double walk = 0;
  if (!main.has_gz()) {
    std::array<double, kWalks.size()> likelihood;
    for (std::size_t i = 0; i < kWalks.size(); ++i) {
      likelihood[i] = bank[i].Close(NoiseOf(kWalks[i]));
    }
    double sum = 0, mean = 0;
    for (std::size_t i = 0; i < kWalks.size(); ++i) {
      sum += weight[i];
      mean += weight[i] * std::log(kWalks[i]);
    }
    walk = std::exp(mean / sum);
    main.Close(NoiseOf(walk));
    Weigh(likelihood, seconds);
  } else {
    main.Close(noise);
  }
  ready = true;
}

VerticalFilter::VerticalFilter(const VerticalSetup& setup) : impl_(std::make_unique<Impl>(setup)) {}
VerticalFilter::~VerticalFilter() = default;
VerticalFilter::VerticalFilter(const VerticalFilter& other)
    : impl_(std::make_unique<Impl>(*other.impl_)) {}
VerticalFilter& VerticalFilter::operator=(const VerticalFilter& other) {
  *impl_ = *other.impl_;
  return *this;
}
VerticalFilter::VerticalFilter(VerticalFilter&&) noexcept = default;
VerticalFilter& VerticalFilter::operator=(VerticalFilter&&) noexcept = default;

void VerticalFilter::Push(const ImuSample& sample, const AlongHole& along, const Site& site) {
  Impl& m = *impl_;
  const SampleStamp& stamp = sample.stamp;
  if (stamp.period_ns <= 0 || !IsFinite(sample)) return;
  if (!m.started) {
    m.Start(sample, along, site);
  } else {
    const double apart = (stamp.tool_time - m.end).seconds(), period = 1e-9 * stamp.period_ns;
    if (stamp.session == m.session && apart < -period / 2) return;
    if (stamp.session != m.session) {
      m.Start(sample, along, site);
    } else if (apart > period / 2) {
      m.Close();
      const auto widen = [&](Core& core) { core.Widen(apart, m.setup.gap_rate * apart, 0.1); };
      widen(m.main);
      for (Core& core : m.bank) widen(core);
    }
  }
  m.session = stamp.session;
  m.end = stamp.tool_time + Duration{stamp.period_ns};
  m.main.Predict(SensedOf(sample, along, site, m.main.R_LT()));
  if (!sample.has_gz) {
    for (Core& core : m.bank) core.Predict(SensedOf(sample, along, site, core.R_LT()));
  }
  if (m.main.block_seconds() > kBlockSeconds - 1e-9) m.Close();
}

void VerticalFilter::SetAzimuth(double azimuth, double variance) {
  Impl& m = *impl_;
  if (m.main.block_seconds() > 0) m.Close();
  const Eigen::Matrix3d before = m.main.R_LT();
  m.main.SetHeading(azimuth, variance);
  const Eigen::Matrix3d& after = m.main.R_LT();
  const double turned =
      std::atan2(after(1, 2), after(0, 2)) - std::atan2(before(1, 2), before(0, 2));
  for (Core& core : m.bank) {
    core.SetHeading(std::atan2(core.R_LT()(1, 2), core.R_LT()(0, 2)) + turned, variance);
  }
}

bool VerticalFilter::ready() const { return impl_->ready; }

AttitudeSample VerticalFilter::attitude() const {
  const Core& core = impl_->main;
  const Eigen::Matrix3d& R = core.R_LT();
  AttitudeSample a;
  a.time = impl_->end;
  a.inclination = std::atan2(std::hypot(R(0, 2), R(1, 2)), R(2, 2));
  a.azimuth = WrapTwoPi(std::atan2(R(1, 2), R(0, 2)));
  a.toolface = std::atan2(R(2, 1), -R(2, 0));
  const Eigen::Matrix3d slopes = vertical::EulerSlopes(R);
  a.cov_attitude = slopes * impl_->CovTurn() * slopes.transpose();
  a.azimuth_known = a.cov_attitude(1, 1) < kFlat;
  return a;
}

double VerticalFilter::axial_rate() const { return impl_->main.axial(); }
double VerticalFilter::sigma_axial_rate() const {
  return std::sqrt(impl_->main.cov()(vertical::kAxial, vertical::kAxial));
}

}  // namespace wellgyro
