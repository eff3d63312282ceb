#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/depth/depth_track.h"
#include "wellgyro/math/random.h"

#include "depth/marks.h"
#include "depth/utc.h"

namespace wellgyro {
namespace {

// Half a metre a second with a slow swing of the winch: what the header promises, rms.
TEST(DepthTrack, CentimetreCountsGiveQuietSpeedAndAcceleration) {
  const auto md = [](double t) { return 1000 + 0.5 * t + 0.2 * std::sin(0.2 * t); };
  struct Case {
    double rate, speed, acceleration;
  };
  for (const auto& c : {Case{20, 2e-3, 3e-3}, Case{10, 2e-3, 3e-3}, Case{1, 2e-3, 5e-3}}) {
    const DepthTrack track = Track(Encoder(300, c.rate, md));
    double depth2 = 0, speed2 = 0, acceleration2 = 0, nees = 0;
    int n = 0;
    for (double t = 3; t < 297; t += 0.0437, ++n) {
      const AlongHole along = track.At(Utc(t));
      ASSERT_TRUE(along.known);
      const double v = 0.5 + 0.04 * std::cos(0.2 * t), a = -0.008 * std::sin(0.2 * t);
      depth2 += std::pow(along.md - md(t), 2);
      nees += std::pow((along.md - md(t)) / along.sigma_md, 2);
      speed2 += std::pow(along.speed - v, 2);
      acceleration2 += std::pow(along.acceleration - a, 2);
    }
    EXPECT_LT(std::sqrt(depth2 / n), 0.0035) << c.rate;
    EXPECT_LT(std::sqrt(speed2 / n), c.speed) << c.rate;
    EXPECT_LT(std::sqrt(acceleration2 / n), c.acceleration) << c.rate;
    // Within a count all errors are alike likely, which no sigma of a mean of many foretells.
    EXPECT_LT(nees / n, 1.2) << c.rate;
    EXPECT_GT(nees / n, 0.02) << c.rate;
  }
}

// The still detector takes 6 mm/s, or four sigmas of the speed, in the mean of a second, for rest.
TEST(DepthTrack, OneCountWhileStandingReadsAsNoMoreThanRestAllows) {
  for (const double rate : {1.0, 2.0, 5.0, 20.0}) {
    const DepthTrack track =
        Track(Encoder(60, rate, [](double t) { return t < 30.01 ? 10 : 10.01; }));
    double worst = 0, beyond = 0;
    for (double second = 20; second < 40; second += 0.13) {
      double speed = 0, sigma = 0;
      for (double t = second; t < second + 1; t += 0.01) {
        const AlongHole along = track.At(Utc(t));
        worst = std::max(worst, std::abs(along.speed));
        speed += 0.01 * std::abs(along.speed);
        sigma += 0.01 * along.sigma_speed;
      }
      beyond = std::max(beyond, speed / std::max(0.006, 4 * sigma));
    }
    EXPECT_LT(worst, 0.012) << rate;
    EXPECT_GT(worst, 0.003) << rate;
    EXPECT_LT(beyond, 1) << rate;
  }
}

TEST(DepthTrack, NoiseOfTheMarksIsInTheSigmaOfTheSpeed) {
  constexpr double kNoise = 0.02;
  for (const double rate : {2.0, 10.0}) {
    Random random(7);
    std::vector<DepthMark> marks;
    for (int i = 0; i <= 600 * rate; ++i) {
      marks.push_back(Mark(i / rate, 500 + kNoise * random.Normal(), i));
    }
    const DepthTrack track = Track(marks);
    double speed2 = 0, md2 = 0;
    int n = 0;
    for (double t = 5; t < 595; t += 2.1, ++n) {
      const AlongHole along = track.At(Utc(t));
      ASSERT_GT(along.sigma_speed, 0);
      speed2 += std::pow(along.speed / along.sigma_speed, 2);
      md2 += std::pow((along.md - 500) / along.sigma_md, 2);
    }
    // The scatter of a few marks is itself known to a third.
    EXPECT_NEAR(speed2 / n, 1, 0.6) << rate;
    EXPECT_LT(md2 / n, 3) << rate;
    EXPECT_GT(md2 / n, 0.3) << rate;
  }
}

TEST(DepthTrack, RareMarksAreJoinedWithoutJumpsAndSayWhatTheyDoNotKnow) {
  // A stop, ten seconds of getting under way, a steady way.
  const auto md = [](double t) {
    if (t < 30) return 200.0;
    if (t < 40) return 200 + 0.05 * (t - 30) * (t - 30);
    return 205 + (t - 40);
  };
  for (const double every : {2.0, 4.0, 20.0}) {
    std::vector<DepthMark> marks;
    for (int i = 0; i * every <= 120; ++i) marks.push_back(Mark(i * every, md(i * every), i));
    DepthTrackSetup setup;
    setup.max_gap = Duration::Seconds(2.5 * every);
    DepthTrack track(setup);
    for (const DepthMark& mark : marks) ASSERT_FALSE(track.Push(mark));
    double last = 0, last_speed = 0, worst = 0;
    bool first = true;
    for (double t = 0; t < 100; t += 0.01) {
      const AlongHole along = track.At(Utc(t));
      ASSERT_TRUE(along.known) << t;
      if (!first) {
        EXPECT_GE(along.md, last - 1e-9) << "monotone at " << t;
        EXPECT_LT(std::abs(along.speed - last_speed), 0.02) << "smooth at " << t;
      }
      first = false;
      last = along.md;
      last_speed = along.speed;
      worst = std::max(worst, std::abs(along.md - md(t)) / along.sigma_md);
    }
    EXPECT_LT(worst, 3) << every;
    EXPECT_LT(track.At(Utc(5)).sigma_acceleration, every < 5 ? 1e-9 : 0.02);
    EXPECT_GT(track.At(Utc(33)).sigma_acceleration, 0.02) << "getting under way " << every;
    if (every < 5) {
      EXPECT_LT(track.At(Utc(80)).sigma_acceleration, 1e-9) << every;
      EXPECT_LT(track.At(Utc(80)).sigma_md, 0.005) << every;
    } else {
      EXPECT_GT(track.At(Utc(90)).sigma_md, 1) << "a stop may hide in 20 s";
    }
  }
}

}  // namespace
}  // namespace wellgyro
