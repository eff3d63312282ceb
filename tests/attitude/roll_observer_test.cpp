// A third gyro axis away from vertical: the same where nothing shakes, far better where something
// does.
#include "wellgyro/attitude/roll_observer.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"

#include "attitude/tracker_truth.h"

namespace wellgyro {
namespace {

using truth::Flight;
using truth::Motion;
using truth::Path;

double EndError(const Path& path, const Flight& flight) {
  const std::vector<Knot> knots = truth::Fly(path, flight);
  const Motion begin = path(0), end = path(flight.seconds);
  const std::vector<double> azimuths =
      truth::Propagate(begin.azimuth, begin.inclination, knots, flight.site);
  return ToDegrees(WrapPi(azimuths.back() - end.azimuth));
}

TEST(RollObserver, APerfectToolIsAsGoodWithAThirdAxis) {
  for (const double inclination : {10.0, 30.0, 60.0, 90.0, 110.0}) {
    for (const double rate : {10.0, 100.0}) {
      Flight flight{.sensors = {.has_gz = true}, .rate = rate, .seconds = 600};
      EXPECT_LT(std::abs(EndError(truth::Hour(inclination), flight)), 1e-4)
          << inclination << " " << rate;
    }
  }
}

/// Whirl of 0.05 deg with roll of 0.2 deg at 8 Hz: the tool of the note's section 2.
Path Whirling(double inclination_deg) {
  return [slow = truth::Slide(inclination_deg)](double t) {
    Motion m = slow(t);
    const double w = kTwoPi * 8, roll = FromDegrees(0.2);
    const double lean = FromDegrees(0.05);
    m.inclination += lean * std::sin(w * t);
    m.inclination_rate += lean * w * std::cos(w * t);
    m.toolface += roll * std::cos(w * t);
    m.toolface_rate -= roll * w * std::sin(w * t);
    m.toolface_acceleration -= roll * w * w * std::cos(w * t);
    return m;
  };
}

// Off-axis accelerometers read six times the roll at 8 Hz. The third gyro does not care where they
// sit.
TEST(RollObserver, RollThatAccelerometersCannotSeeIsNoAzimuth) {
  Flight flight{.sensors = {.p_accel_T = {0.02, 0.01, 0}}, .rate = 100, .seconds = 300};
  const double two = std::abs(EndError(Whirling(60), flight));
  flight.sensors.has_gz = true;
  const double three = std::abs(EndError(Whirling(60), flight));
  std::printf("whirl of 8 Hz, accelerometers 2 cm off axis: %.3g deg, with a third axis %.3g deg\n",
              two, three);
  EXPECT_GT(two, 1);
  EXPECT_LT(three, 0.02 * two);
}

/// Noisy samples of one path, with and without the third axis.
struct Noisy {
  std::vector<ImuSample> clean;
  TrackerOptions options;
  double gyro_noise = 0;  ///< of every axis [rad/sqrt(s)]
  double scale = 0;       ///< of the third axis [1]
  double bias = 0;        ///< the same [rad/s]

  Knot Fly(const Path& path, double rate, std::uint64_t seed, double noisy, bool gz) const {
    Random random(seed);
    HighSideTracker tracker(options);
    const Site site = truth::SiteOf(FromDegrees(60));
    for (ImuSample sample : clean) {
      sample.w_IT_T.z() = (1 + noisy * scale) * sample.w_IT_T.z() + noisy * bias;
      for (int i = 0; i < 3; ++i) {
        const double w = random.Normal(), f = random.Normal();
        sample.w_IT_T(i) += noisy * gyro_noise * std::sqrt(rate) * w;
        sample.f_T(i) += noisy * options.accel_noise * std::sqrt(rate) * f;
      }
      sample.has_gz = gz;
      if (!gz) sample.w_IT_T.z() = 0;
      const double t = (static_cast<double>(sample.stamp.seq) + 0.5) / rate;
      tracker.Push(sample, truth::AlongAt(path, t), site);
      if (sample.stamp.seq == 600) tracker.CutKnot();
    }
    tracker.Flush();
    return tracker.CutKnot();
  }
};

// With a poor third one: bias 5 deg/h, scale wrong by 2e-4, walk as that of the others.
TEST(RollObserver, IsNeverWorseThanTwoAxesAndItsSigmasAreTrue) {
  constexpr double kRate = 10;
  constexpr int kSeeds = 100;
  for (const double inclination : {15.0, 60.0}) {
    const Path path = truth::Hour(inclination);
    const Site site = truth::SiteOf(FromDegrees(60));
    Noisy tool;
    tool.options.accel_noise = 1e-3;
    tool.gyro_noise = 0.01 * units::kDegPerSqrtHour;
    tool.scale = 2e-4;
    tool.bias = 5 * units::kDegPerHour;
    for (std::int64_t k = 0; k < 4600; ++k) {
      tool.clean.push_back(truth::SampleAt(path, {.has_gz = true}, site, k, kRate));
    }
    const Knot clean = tool.Fly(path, kRate, 0, 0, true);
    const Knot clean_two = tool.Fly(path, kRate, 0, 0, false);
    double two = 0, three = 0, turn = 0, toolface = 0, toolface_two = 0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      const auto s = static_cast<std::uint64_t>(seed);
      const Knot with = tool.Fly(path, kRate, s, 1, true);
      const Knot without = tool.Fly(path, kRate, s, 1, false);
      two += std::pow(without.turn - clean_two.turn, 2);
      three += std::pow(with.turn - clean.turn, 2);
      const double white = std::pow(tool.gyro_noise, 2) * clean.white_turn;
      turn += std::pow(with.turn - clean.turn, 2) / (white + clean.toolface_noise_turn);
      toolface += std::pow(WrapPi(with.toolface - clean.toolface), 2) / with.var_toolface;
      toolface_two +=
          std::pow(WrapPi(without.toolface - clean_two.toolface), 2) / with.var_toolface;
    }
    std::printf("%g deg: rms turn %.4g, with a third axis %.4g deg; toolface %.3g of what it was\n",
                inclination, ToDegrees(std::sqrt(two / kSeeds)),
                ToDegrees(std::sqrt(three / kSeeds)), std::sqrt(toolface / toolface_two));
    EXPECT_LT(three, 1.02 * two);
    EXPECT_LT(toolface, 0.2 * toolface_two);
    for (const double sum : {turn, toolface}) {
      EXPECT_GT(sum, ChiSquareQuantile(1e-3, kSeeds)) << inclination;
      EXPECT_LT(sum, ChiSquareQuantile(1 - 1e-3, kSeeds)) << inclination;
    }
  }
}

TEST(RollObserver, BeginsAnewAfterAGap) {
  RollObserver observer(2);
  const auto take = [&](double toolface) {
    double c = std::cos(toolface), s = std::sin(toolface);
    observer.Take(0.1, 0.1, true, c, s);
    return std::atan2(s, c);
  };
  for (int i = 0; i < 100; ++i) take(0.1 * i);
  EXPECT_GT(std::abs(WrapPi(take(2.0) - 2.0)), 0.5) << "it trusts the gyro";
  observer.Forget();
  EXPECT_NEAR(take(2.0), 2.0, 1e-12);
}

TEST(RollObserver, GoesOnByTheGyroWhereTheForceSaysNothing) {
  RollObserver observer(2);
  const auto take = [&](int i, bool trusted) {
    const double mean = 0.1 * (i + 0.5);
    double c = trusted ? std::cos(mean) : 0, s = trusted ? std::sin(mean) : -1;
    observer.Take(0.1, 0.1, trusted, c, s);
    return WrapPi(std::atan2(s, c) - mean);
  };
  for (int i = 0; i < 50; ++i) EXPECT_NEAR(take(i, true), 0, 1e-12);
  for (int i = 50; i < 100; ++i) EXPECT_NEAR(take(i, false), 0, 1e-12);
}

}  // namespace
}  // namespace wellgyro
