#include "wellgyro/calibration/spike_filter.h"

#include <cmath>
#include <cstdint>
#include <functional>
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

std::vector<SpikeFilter::Out> Filtered(const std::vector<ImuSample>& samples) {
  NoiseCoefficients gyro;
  gyro.angle_random_walk = kWalk;
  ErrorPriors errors;
  errors.accel_noise = kForceNoise;
  SpikeFilter filter(gyro, errors);
  std::vector<SpikeFilter::Out> out;
  const auto drain = [&] {
    while (const SpikeFilter::Out* one = filter.Flush()) out.push_back(*one);
  };
  for (const ImuSample& sample : samples) {
    if (!filter.Continues(sample.stamp)) drain();
    if (const SpikeFilter::Out* one = filter.Push(sample, sample.stamp.seq == 5)) {
      out.push_back(*one);
    }
  }
  drain();
  return out;
}

std::vector<ImuSample> Samples(int n, double rpm, Random* random) {
  std::vector<ImuSample> samples;
  for (int k = 0; k < n; ++k) samples.push_back(Rolling(k, rpm, random));
  return samples;
}

TEST(SpikeFilter, GivesEverySampleInOrderWithItsMark) {
  std::vector<ImuSample> samples = Samples(40, 1, nullptr);
  samples.erase(samples.begin() + 20, samples.begin() + 23);
  const auto out = Filtered(samples);
  ASSERT_EQ(out.size(), samples.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    EXPECT_EQ(out[i].sample.stamp.seq, samples[i].stamp.seq);
    EXPECT_EQ(out[i].sample.f_T, samples[i].f_T);
    EXPECT_EQ(out[i].mark, samples[i].stamp.seq == 5);
  }
}

TEST(SpikeFilter, LeavesNoiseAndRollAlone) {
  for (const double rpm : {0.0, 1.0, 10.0, 60.0}) {
    Random random(3);
    int touched = 0;
    for (const SpikeFilter::Out& out : Filtered(Samples(50'000, rpm, &random))) {
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
  for (const SpikeFilter::Out& one : Filtered(shaken)) touched += one.accel;
  EXPECT_LE(touched, 3);
}

TEST(SpikeFilter, AtABreakNothingIsReplaced) {
  std::vector<ImuSample> samples = Samples(40, 1, nullptr);
  samples[1].w_IT_T.x() = samples[21].w_IT_T.x() = samples[38].w_IT_T.x() = 1;
  for (std::size_t k = 20; k < 40; ++k) samples[k].stamp.session = 2;
  for (const SpikeFilter::Out& out : Filtered(samples)) EXPECT_FALSE(out.gyro);
}

}  // namespace
}  // namespace wellgyro
