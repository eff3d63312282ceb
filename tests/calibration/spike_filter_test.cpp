#include "wellgyro/calibration/spike_filter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

constexpr double kWalk = 0.005 * units::kDegPerSqrtHour, kForceNoise = 2e-4;
constexpr std::int32_t kPeriod = 100'000'000;

/// A tool that rolls at `rpm` at 60 deg of inclination.
ImuSample Rolling(std::int64_t seq, double rpm, Random* random) {
  ImuSample sample;
  sample.stamp.seq = seq;
  sample.stamp.session = 1;
  sample.stamp.period_ns = kPeriod;
  const double roll = kTwoPi * rpm / 60 * static_cast<double>(seq) * 0.1;
  sample.w_IT_T = {5e-5 * std::cos(roll), -5e-5 * std::sin(roll), 0};
  sample.f_T = {8.5 * std::cos(roll), -8.5 * std::sin(roll), -4.9};
  if (random == nullptr) return sample;
  for (int i = 0; i < 2; ++i) sample.w_IT_T[i] += kWalk / std::sqrt(0.1) * random->Normal();
  for (int i = 0; i < 3; ++i) sample.f_T[i] += kForceNoise / std::sqrt(0.1) * random->Normal();
  return sample;
}

struct Out {
  ImuSample sample;
  bool gyro = false, accel = false;
};

ErrorPriors Errors() {
  ErrorPriors errors;
  errors.accel_noise = kForceNoise;
  return errors;
}

NoiseCoefficients Noise() {
  NoiseCoefficients gyro;
  gyro.angle_random_walk = kWalk;
  return gyro;
}

/// In blocks of `block` samples.
std::vector<Out> Filtered(const std::vector<ImuSample>& samples, std::size_t block = 1,
                          double quantization = 0) {
  NoiseCoefficients noise = Noise();
  noise.quantization = quantization;
  SpikeFilter filter(noise, Errors());
  std::vector<Out> out;
  const auto keep = [&](const SpikeFilter::Done& done) {
    ASSERT_LE(out.size() + done.axes.size(), samples.size());
    for (std::size_t i = 0; i < done.axes.size(); ++i) {
      Out one{samples[out.size()], done.mended[i].gyro, done.mended[i].accel};
      EXPECT_EQ(one.gyro, done.axes[i].head<3>().matrix() != one.sample.w_IT_T);
      EXPECT_EQ(one.accel, done.axes[i].tail<3>().matrix() != one.sample.f_T);
      one.sample.w_IT_T = done.axes[i].head<3>();
      one.sample.f_T = done.axes[i].tail<3>();
      out.push_back(one);
    }
  };
  for (std::span<const ImuSample> rest(samples); !rest.empty();) {
    if (!filter.Continues(rest.front().stamp)) keep(filter.Flush());
    const SpikeFilter::Done done = filter.Push(rest.first(std::min(block, rest.size())));
    keep(done);
    EXPECT_GE(done.taken, 1u);
    rest = rest.subspan(std::max<std::size_t>(done.taken, 1));
  }
  keep(filter.Flush());
  return out;
}

double& AxisOf(ImuSample& sample, int axis) {
  return axis < 3 ? sample.w_IT_T[axis] : sample.f_T[axis - 3];
}

/// One axis of one stretch, sample by sample, as the class says it in words.
void MendAxis(std::vector<Out>& out, int axis) {
  const double least = axis < 3 ? 1e-5 : 1e-3, noise = axis < 3 ? kWalk : kForceNoise;
  const double floor = 8.4 * noise * (1 / std::sqrt(1e-9 * kPeriod)) + least;
  const auto x = [&](std::size_t i) -> double& { return AxisOf(out[i].sample, axis); };
  const auto beyond = [&](std::size_t i) {
    return x(i) - (4 * (x(i - 1) + x(i + 1)) - x(i - 2) - x(i + 2)) / 6;
  };
  for (std::size_t i = 3; i + 3 < out.size(); ++i) {
    const double off = beyond(i);
    if (std::abs(off) <= floor) continue;
    const double lively = std::max(std::abs(beyond(i - 1) + off * (2.0 / 3)),
                                   std::abs(beyond(i + 1) + off * (2.0 / 3)));
    std::vector<double> near = {x(i - 3), x(i - 2), x(i - 1), x(i + 1), x(i + 2), x(i + 3)};
    std::ranges::sort(near);
    const double median = (near[2] + near[3]) / 2;
    if (std::abs(off) > 10 * lively + floor) {
      x(i) -= off;
    } else if (std::abs(x(i) - median) > 3 * (near[4] - near[1]) + floor) {
      x(i) = median;
    } else {
      continue;
    }
    (axis < 3 ? out[i].gyro : out[i].accel) = true;
  }
}

std::vector<ImuSample> Samples(int n, double rpm, Random* random) {
  std::vector<ImuSample> samples;
  for (int k = 0; k < n; ++k) samples.push_back(Rolling(k, rpm, random));
  return samples;
}

// At the Earth's rate a gyro of 7 arcsec a pulse reads nothing in four of five samples, and a pulse
// between them is none of a spike.
TEST(SpikeFilter, PulsesOfACountingGyroAreNoSpikes) {
  constexpr double kPulse = 7 * units::kArcsec, kSeconds = 0.1;
  Random random(8);
  Eigen::Vector2d rest = Eigen::Vector2d::Zero();
  std::vector<ImuSample> samples;
  for (int k = 0; k < 6000; ++k) {
    samples.push_back(Rolling(k, 0.5, &random));
    for (int i = 0; i < 2; ++i) {
      double& rate = samples.back().w_IT_T[i];
      rest[i] += rate * kSeconds;
      const double counted = std::nearbyint(rest[i] / kPulse) * kPulse;
      rest[i] -= counted;
      rate = counted / kSeconds;
    }
  }
  const auto mended = [&](double quantization) {
    const std::vector<Out> out = Filtered(samples, 10, quantization);
    return std::count_if(out.begin(), out.end(), [](const Out& o) { return o.gyro; });
  };
  EXPECT_EQ(mended(kPulse / std::sqrt(12.0)), 0);
  EXPECT_GT(mended(0), 100) << "where nobody says that it counts";
  samples[3000].w_IT_T.x() += 0.01;  // 0.6 deg/s
  EXPECT_EQ(mended(kPulse / std::sqrt(12.0)), 1);
}

TEST(SpikeFilter, GivesEverySampleInOrder) {
  std::vector<ImuSample> samples = Samples(40, 1, nullptr);
  samples.erase(samples.begin() + 20, samples.begin() + 23);
  const auto out = Filtered(samples);
  ASSERT_EQ(out.size(), samples.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    EXPECT_EQ(out[i].sample.stamp.seq, samples[i].stamp.seq);
    EXPECT_EQ(out[i].sample.f_T, samples[i].f_T);
  }
}

TEST(SpikeFilter, DoesToTheBitWhatItSaysInBlocksOfAnySize) {
  Random random(11);
  std::vector<ImuSample> samples = Samples(3000, 3, &random);
  for (int k = 0; k < 200; ++k) {
    const auto at = static_cast<std::size_t>(2900 * random.Uniform());
    const auto axis = static_cast<int>(6 * random.Uniform());
    if (axis == 2) continue;
    // From what the floor hides to what is plain, and some beside each other.
    AxisOf(samples[at], axis) += (axis < 3 ? 1e-4 : 1e-2) * std::exp(random.Normal());
    if (k % 5 == 0) AxisOf(samples[at + 1], axis) -= axis < 3 ? 1e-2 : 1;
  }
  std::vector<Out> expected;
  for (const ImuSample& sample : samples) expected.push_back({sample});
  for (const int axis : {0, 1, 3, 4, 5}) MendAxis(expected, axis);
  int mended = 0;
  for (const Out& one : expected) mended += one.gyro || one.accel;
  EXPECT_GT(mended, 50);
  for (const std::size_t block : {1u, 2u, 5u, 63u, 64u, 500u}) {
    const std::vector<Out> out = Filtered(samples, block);
    ASSERT_EQ(out.size(), expected.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      EXPECT_EQ(out[i].sample.w_IT_T, expected[i].sample.w_IT_T) << block << " " << i;
      EXPECT_EQ(out[i].sample.f_T, expected[i].sample.f_T) << block << " " << i;
      EXPECT_EQ(out[i].gyro, expected[i].gyro) << block << " " << i;
      EXPECT_EQ(out[i].accel, expected[i].accel) << block << " " << i;
    }
  }
}

TEST(SpikeFilter, LeavesNoiseAndRollAlone) {
  for (const double rpm : {0.0, 1.0, 10.0, 60.0}) {
    Random random(3);
    int touched = 0;
    for (const Out& out : Filtered(Samples(50'000, rpm, &random))) {
      touched += out.gyro || out.accel;
    }
    EXPECT_EQ(touched, 0) << rpm;
  }
}

TEST(SpikeFilter, ReplacesASpikeByWhatItsNeighboursSay) {
  for (const double rpm : {0.0, 3.0, 10.0}) {
    Random random(5);
    std::vector<ImuSample> samples = Samples(1000, rpm, &random);
    const std::vector<ImuSample> clean = samples;
    for (std::size_t k = 50; k < 990; k += 50) samples[k].w_IT_T.x() += units::kDeg;
    samples[620].f_T.y() -= 3;
    const auto out = Filtered(samples);
    for (std::size_t k = 0; k < samples.size(); ++k) {
      EXPECT_EQ(out[k].gyro, k >= 50 && k < 990 && k % 50 == 0) << k;
      EXPECT_EQ(out[k].accel, k == 620) << k;
      // Of the cubic's noise and the sample's own: 1.4 sigma; its bow at 10 rpm is 2e-6 of 8.5.
      EXPECT_NEAR(out[k].sample.w_IT_T.x(), clean[k].w_IT_T.x(), 6 * kWalk / std::sqrt(0.1)) << k;
      EXPECT_NEAR(out[k].sample.f_T.y(), clean[k].f_T.y(), 6 * kForceNoise / std::sqrt(0.1)) << k;
    }
  }
}

TEST(SpikeFilter, FindsTwoBesideEachOtherAndGoesBlindInAVibration) {
  Random random(7);
  std::vector<ImuSample> samples = Samples(100, 1, &random);
  samples[50].w_IT_T.y() = 1;
  samples[51].w_IT_T.y() = -1;
  const auto out = Filtered(samples);
  EXPECT_TRUE(out[50].gyro && out[51].gyro);
  EXPECT_NEAR(out[50].sample.w_IT_T.y(), 0, 1e-4);
  EXPECT_NEAR(out[51].sample.w_IT_T.y(), 0, 1e-4);
  std::vector<ImuSample> shaken = Samples(100, 1, &random);
  for (ImuSample& sample : shaken) sample.f_T.x() += random.Normal();
  int touched = 0;
  for (const Out& one : Filtered(shaken)) touched += one.accel;
  EXPECT_LE(touched, 3);
}

TEST(SpikeFilter, AtABreakNothingIsReplaced) {
  std::vector<ImuSample> samples = Samples(40, 1, nullptr);
  samples[1].w_IT_T.x() = samples[21].w_IT_T.x() = samples[38].w_IT_T.x() = 1;
  for (std::size_t k = 20; k < 40; ++k) samples[k].stamp.session = 2;
  for (const Out& out : Filtered(samples)) EXPECT_FALSE(out.gyro);
}

}  // namespace
}  // namespace wellgyro
