// What a vertical filter does not see of a passage: samples lost, gyros at full scale, a third axis
// that falls away. 2026-11-21.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "wellgyro/attitude/vertical_filter.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/math/statistics.h"

#include "attitude/vertical_truth.h"

namespace wellgyro {
namespace {

using vertical_truth::AddErrors;
using vertical_truth::AlongAt;
using vertical_truth::AzimuthAt;
using vertical_truth::Crossing;
using vertical_truth::ErrorsAt;
using vertical_truth::Norway;
using vertical_truth::Pass;
using vertical_truth::Samples;
using vertical_truth::Tactical;

constexpr double kRate = 10;  // [Hz]
constexpr int kSeeds = 24;

/// Flies through those samples that are left, the azimuth exactly known after the first second.
AttitudeSample Fly(const Crossing& crossing, const std::vector<ImuSample>& samples) {
  VerticalFilter filter({Tactical().gyro, Tactical().priors});
  for (const ImuSample& s : samples) {
    const double t = 1e-9 * static_cast<double>(s.stamp.tool_time.ns);
    filter.Push(s, AlongAt(crossing, t + 0.5 / kRate), Norway());
    if (s.stamp.seq == 9) filter.SetAzimuth(AzimuthAt(crossing, t + 1 / kRate), 0);
  }
  return filter.attitude();
}

/// Every `every` seconds, `seconds` are lost, but for the last.
void Lose(double every, double seconds, std::vector<ImuSample>& samples) {
  const auto in = [&](const ImuSample& s) {
    return s.stamp.seq < 5300 &&
           std::fmod(static_cast<double>(s.stamp.seq) / kRate, every) >= every - seconds;
  };
  samples.erase(std::remove_if(samples.begin(), samples.end(), in), samples.end());
}

struct Squares {
  Eigen::Vector3d normalised = Eigen::Vector3d::Zero();
  double sum = 0;  ///< of azimuth and toolface
  void Add(const Eigen::Vector3d& error, const Eigen::Matrix3d& cov) {
    normalised += error.cwiseAbs2().cwiseQuotient(cov.diagonal());
    sum += std::pow(error[1] + error[2], 2) / (cov(1, 1) + cov(2, 2) + 2 * cov(1, 2));
  }
};

TEST(VerticalGap, AToolThatTurnsSteadilyTurnsOnOverIt) {
  for (const bool has_gz : {false, true}) {
    const Crossing c = Pass(3, 0.5);
    std::vector<ImuSample> samples = Samples(c, Norway(), kRate, has_gz);
    Lose(50, 2, samples);
    const AttitudeSample a = Fly(c, samples);
    const Eigen::Vector3d error = ErrorsAt(c, c.seconds, a);
    // It turned by 36 deg in each of ten gaps. What is left comes from the path, which bends.
    EXPECT_LT(std::abs(ToDegrees(error[1])), 0.3) << has_gz;
    EXPECT_LT(std::sqrt(a.cov_attitude(1, 1)), FromDegrees(6)) << has_gz;
  }
}

class Lost : public ::testing::TestWithParam<bool> {};

// A roll that swings by 25 deg to both sides in 23 s is another behind each gap.
TEST_P(Lost, BatchesOfASwingingTool) {
  Squares squares;
  Crossing c = Pass(0.3, 1);
  c.wave = FromDegrees(25);
  const std::vector<ImuSample> perfect = Samples(c, Norway(), kRate, GetParam());
  for (int seed = 1; seed <= kSeeds; ++seed) {
    std::vector<ImuSample> samples = perfect;
    AddErrors(Tactical(), static_cast<std::uint64_t>(seed), samples);
    Lose(40 + seed, 2, samples);
    const AttitudeSample a = Fly(c, samples);
    squares.Add(ErrorsAt(c, c.seconds, a), a.cov_attitude);
    EXPECT_LT(std::sqrt(a.cov_attitude(1, 1)), FromDegrees(60));
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(squares.normalised[i], ChiSquareQuantile(0.999, kSeeds)) << i;
    EXPECT_GT(squares.normalised[i], ChiSquareQuantile(0.001, kSeeds) / 9) << i;
  }
}

// A roll that ends in the gap; what the filter expects is wrong by up to half a turn.
TEST_P(Lost, TwentySecondsInWhichTheRollEnds) {
  Squares squares;
  Crossing c = Pass(3, 1);
  c.spin_up = 0;
  Crossing still = c;
  still.rpm = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const std::int64_t gap = 2000 + 40 * seed;
    std::vector<ImuSample> samples = Samples(c, Norway(), kRate, GetParam());
    const std::vector<ImuSample> behind = Samples(still, Norway(), kRate, GetParam());
    std::copy(behind.begin() + gap, behind.end(), samples.begin() + gap);
    AddErrors(Tactical(), static_cast<std::uint64_t>(seed), samples);
    samples.erase(samples.begin() + gap, samples.begin() + gap + 200);
    const AttitudeSample a = Fly(c, samples);
    squares.Add(ErrorsAt(still, c.seconds, a), a.cov_attitude);
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(squares.normalised[i], ChiSquareQuantile(0.999, kSeeds)) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(ThirdAxis, Lost, ::testing::Bool());

// All three gyros read no more than `limit`, and say so.
void Clip(double limit, std::vector<ImuSample>& samples) {
  for (ImuSample& s : samples) {
    const Eigen::Vector3d w = s.w_IT_T;
    s.w_IT_T = w.cwiseMax(-limit).cwiseMin(limit);
    s.stamp.gyro_saturated = s.w_IT_T != w;
  }
}

TEST(VerticalSaturation, OfTheThirdAxisLosesTheSum) {
  // 3 rpm are 18 deg/s; half of that is seen, for eight seconds about the closest.
  Squares squares;
  const Crossing c = Pass(3, 0.2);
  for (int seed = 1; seed <= kSeeds; ++seed) {
    std::vector<ImuSample> samples = Samples(c, Norway(), kRate, true);
    AddErrors(Tactical(), static_cast<std::uint64_t>(seed), samples);
    std::vector<ImuSample> some(samples.begin() + 2660, samples.begin() + 2740);
    Clip(FromDegrees(9), some);
    std::copy(some.begin(), some.end(), samples.begin() + 2660);
    samples.resize(2745);
    const AttitudeSample a = Fly(c, samples);
    squares.Add(ErrorsAt(c, 274.5, a), a.cov_attitude);
  }
  EXPECT_LT(squares.sum, ChiSquareQuantile(0.999, kSeeds));
}

TEST(VerticalSaturation, OfTheTransverseAxesWidens) {
  // The path turns by 80 deg/h, of which 40 are seen from the hundredth second to the closest.
  Squares squares;
  double before = 0, behind = 0;
  const Crossing c = Pass(0, 0.5);
  for (int seed = 1; seed <= kSeeds; ++seed) {
    std::vector<ImuSample> samples = Samples(c, Norway(), kRate, false);
    AddErrors(Tactical(), static_cast<std::uint64_t>(seed), samples);
    samples.resize(2700);
    before += Fly(c, samples).cov_attitude(1, 1);
    std::vector<ImuSample> some(samples.begin() + 1000, samples.end());
    Clip(FromDegrees(40. / 3600), some);
    std::copy(some.begin(), some.end(), samples.begin() + 1000);
    const AttitudeSample a = Fly(c, samples);
    squares.Add(ErrorsAt(c, 270, a), a.cov_attitude);
    behind += a.cov_attitude(1, 1);
  }
  EXPECT_GT(behind, 2 * before);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(squares.normalised[i], ChiSquareQuantile(0.999, kSeeds)) << i;
  }
}

TEST(VerticalThirdAxis, FallsAwayAndComesBack) {
  const Crossing c = Pass(3, 0.5);
  std::vector<ImuSample> samples = Samples(c, Norway(), kRate, true);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const bool minute = i > 1000 && i < 1600;
    if (!minute && i % 100 != 0) continue;
    samples[i].has_gz = false;
    samples[i].w_IT_T.z() = 0;
  }
  const Eigen::Vector3d error = ErrorsAt(c, c.seconds, Fly(c, samples));
  EXPECT_LT(std::abs(ToDegrees(error[1])), 0.05);
  EXPECT_LT(std::abs(ToDegrees(error[0])), 1e-3);
}

}  // namespace
}  // namespace wellgyro
