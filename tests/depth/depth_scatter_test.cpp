// What a depth track says of its own errors, against motions known in closed form.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/depth/depth_track.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"

#include "depth/utc.h"

namespace wellgyro {
namespace {

constexpr double kSeconds = 120;

struct Motion {
  double md = 0, speed = 0, acceleration = 0;
};

/// A change of speed with a continuous second derivative of it.
struct Ramp {
  double begin, seconds, change;
};

/// A swing of the speed.
struct Swing {
  double amplitude, period;
};

struct Way {
  const char* name;
  double speed;
  std::vector<Ramp> ramps = {};
  std::vector<Swing> swings = {};

  Motion At(double t) const {
    Motion m{.md = 500 + speed * t, .speed = speed, .acceleration = 0};
    for (const Ramp& r : ramps) {
      const double x = std::clamp((t - r.begin) / r.seconds, 0.0, 1.0);
      const double past = std::max(0.0, t - r.begin - r.seconds);
      m.md += r.change * (r.seconds * x * x * x * x * (2.5 + x * (x - 3)) + past);
      m.speed += r.change * x * x * x * (10 + x * (6 * x - 15));
      m.acceleration += r.change / r.seconds * 30 * x * x * (1 - x) * (1 - x);
    }
    for (const Swing& s : swings) {
      const double w = kTwoPi / s.period;
      m.md += s.amplitude / w * (1 - std::cos(w * t));
      m.speed += s.amplitude * std::sin(w * t);
      m.acceleration += s.amplitude * w * std::cos(w * t);
    }
    return m;
  }
};

const Way kAtRest{.name = "rest", .speed = 0};
const Way kSteady{.name = "steady", .speed = 0.513};
/// A winch's: ten seconds of getting under way and of coming to a stop.
const Way kRamps{.name = "ramps",
                 .speed = 0,
                 .ramps = {{20, 10, 0.6}, {50, 10, -0.6}, {70, 10, 0.6}, {100, 10, -0.6}}};
/// As short as the track's window.
const Way kStops{
    .name = "stops", .speed = 0.5, .ramps = {{20, 2, -0.5}, {35, 2, 0.5}, {70, 2, -0.5}}};
/// A string that sticks and comes free again, in as much as half the window.
const Way kStick{.name = "stick", .speed = 0.4, .swings = {{0.15, 8.3}, {0.05, 3.1}}};

struct Errors {
  std::array<double, 3> squared{};  ///< normalised, summed: depth, speed, acceleration
  int count = 0;
};

/// Marks of white scatter, at every whole window an instant.
Errors ErrorsOn(const Way& way, double rate, double scatter, int seeds) {
  Errors errors;
  for (int seed = 1; seed <= seeds; ++seed) {
    Random random(static_cast<std::uint64_t>(1000 * seed) + static_cast<std::uint64_t>(rate));
    DepthTrack track;
    const double phase = random.Uniform() / rate;
    for (int i = 0; i / rate + phase <= kSeconds; ++i) {
      DepthMark mark;
      mark.utc = Utc(i / rate + phase);
      mark.seq = i;
      mark.md = way.At(i / rate + phase).md + scatter * random.Normal();
      static_cast<void>(track.Push(mark));  // one in a thousand of 10 cm at 10 Hz is a spike
    }
    for (double t = 8 + 4 * random.Uniform(); t < kSeconds - 4; t += 4.1) {
      const AlongHole along = track.At(Utc(t));
      const Motion truth = way.At(t);
      EXPECT_TRUE(along.known);
      errors.squared[0] += std::pow((along.md - truth.md) / along.sigma_md, 2);
      errors.squared[1] += std::pow((along.speed - truth.speed) / along.sigma_speed, 2);
      errors.squared[2] +=
          std::pow((along.acceleration - truth.acceleration) / along.sigma_acceleration, 2);
      ++errors.count;
    }
  }
  return errors;
}

constexpr std::array<const char*, 3> kNames{"depth", "speed", "acceleration"};

class Scatter : public ::testing::TestWithParam<double> {};

TEST_P(Scatter, OfTheMarksIsInTheSigmasAsLargeAsItIs) {
  for (const Way& way : {kAtRest, kSteady}) {
    for (const double rate : {1.0, 2.0, 4.0, 10.0}) {
      const Errors errors = ErrorsOn(way, rate, GetParam(), 10);
      for (std::size_t k = 0; k < 3; ++k) {
        const double sum = errors.squared[k];
        EXPECT_GT(sum, ChiSquareQuantile(1e-3, errors.count))
            << way.name << ' ' << kNames[k] << " at " << rate << " Hz: " << sum / errors.count;
        EXPECT_LT(sum, ChiSquareQuantile(1 - 1e-3, errors.count))
            << way.name << ' ' << kNames[k] << " at " << rate << " Hz: " << sum / errors.count;
      }
    }
  }
}

// A parabola over four seconds follows no sudden change of speed. What it misses is in the sigmas
// where it can be told from scatter, and the rest is at most some times as much: three times the
// sigma where the string sticks within a window.
TEST_P(Scatter, AndWhatAParabolaMissesAreInTheSigmasWithinAFactor) {
  for (const Way& way : {kRamps, kStops, kStick}) {
    for (const double rate : {1.0, 2.0, 4.0, 10.0}) {
      const Errors errors = ErrorsOn(way, rate, GetParam(), 10);
      std::printf("%-6s %4.0f Hz %5.3f m:", way.name, rate, GetParam());
      const std::array<double, 3> most = way.speed == kStick.speed
                                             ? std::array<double, 3>{2, 10, 14}
                                             : std::array<double, 3>{1.6, 5, 5};
      for (std::size_t k = 0; k < 3; ++k) {
        const double mean = errors.squared[k] / errors.count;
        std::printf(" %s %5.2f", kNames[k], mean);
        EXPECT_LT(mean, most[k]) << way.name << ' ' << kNames[k] << " at " << rate << " Hz";
        EXPECT_GT(mean, 0.1) << way.name << ' ' << kNames[k] << " at " << rate << " Hz";
      }
      std::printf("\n");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OneSigma, Scatter, ::testing::Values(0.005, 0.02, 0.1));

// A 1 cm encoder reads the same for as long as the tool creeps within a count, and may do so at a
// speed of a whole number of counts from mark to mark: all marks are then wrong alike.
TEST(EncoderRounding, IsInTheSigmasWhereItDoesNotAverage) {
  for (const double speed : {0.0, 0.004, 0.03, 0.5, 0.513}) {
    for (const double rate : {2.0, 10.0}) {
      double md = 0, speeds = 0;
      int count = 0;
      for (int seed = 1; seed <= 40; ++seed) {
        Random random(static_cast<std::uint64_t>(seed));
        const double start = 500 + 0.01 * random.Uniform();
        DepthTrack track;
        for (int i = 0; i <= 20 * rate; ++i) {
          DepthMark mark;
          mark.utc = Utc(i / rate);
          mark.seq = i;
          mark.md = std::nearbyint((start + speed * i / rate) * 100) / 100;
          EXPECT_FALSE(track.Push(mark));
        }
        for (double t = 4 + random.Uniform(); t < 12; t += 4.1, ++count) {
          const AlongHole along = track.At(Utc(t));
          md += std::pow((along.md - start - speed * t) / along.sigma_md, 2);
          speeds += std::pow((along.speed - speed) / along.sigma_speed, 2);
        }
      }
      EXPECT_LT(md / count, 1.5) << speed << " m/s at " << rate << " Hz";
      EXPECT_LT(speeds / count, 4) << speed << " m/s at " << rate << " Hz";
    }
  }
}

}  // namespace
}  // namespace wellgyro
