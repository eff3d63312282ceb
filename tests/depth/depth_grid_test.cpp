#include "wellgyro/depth/depth_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"

#include "depth/utc.h"

namespace wellgyro {
namespace {

void Push(DepthTrack& track, double seconds, double md, std::int64_t seq) {
  DepthMark mark;
  mark.utc = Utc(seconds);
  mark.seq = seq;
  mark.session = 1;
  mark.md = md;
  ASSERT_FALSE(track.Push(mark));
}

/// A winch that swings, by an encoder of 1 cm counts.
double Swinging(double t) { return 500 + 0.8 * t + 0.3 * std::sin(kTwoPi * t / 7); }

TEST(DepthGrid, SaysWhatTheTrackSaysWithinItsBounds) {
  for (const double rate : {1.0, 2.0, 10.0, 20.0}) {
    DepthTrack track;
    for (int i = 0; i <= 60 * rate; ++i) {
      Push(track, i / rate, std::floor(Swinging(i / rate) * 100) / 100, i);
    }
    DepthGrid grid(track);
    double md = 0, speed = 0, acceleration = 0;
    for (double t = 5; t < 55; t += 0.0037) {
      const AlongHole coarse = grid.At(Utc(t)), fine = track.At(Utc(t));
      ASSERT_TRUE(coarse.known && fine.known) << t;
      md = std::max(md, std::abs(coarse.md - fine.md));
      speed = std::max(speed, std::abs(coarse.speed - fine.speed));
      acceleration = std::max(acceleration, std::abs(coarse.acceleration - fine.acceleration));
    }
    std::printf("%4.0f Hz: depth %.2g m, speed %.2g m/s, acceleration %.2g m/s2\n", rate, md, speed,
                acceleration);
    EXPECT_LT(md, rate > 2 ? 1e-3 : rate > 1 ? 2e-3 : 1e-2) << rate;
    EXPECT_LT(speed, rate > 2 ? 1e-3 : 7e-3) << rate;
    EXPECT_LT(acceleration, rate > 2 ? 3e-3 : rate > 1 ? 7e-3 : 25e-3) << rate;
  }
}

TEST(DepthGrid, IsTheTrackItselfAtItsNodesAndAroundWhateverBreaksIt) {
  DepthTrack track;
  for (int i = 0; i <= 300; ++i) Push(track, i * 0.1, Swinging(i * 0.1), i);
  // A jump of the counter at 30 s, a hole in the marks from 60 s to 70 s.
  for (int i = 301; i <= 600; ++i) Push(track, i * 0.1, Swinging(i * 0.1) + 5, i);
  for (int i = 700; i <= 1000; ++i) Push(track, i * 0.1, Swinging(i * 0.1) + 5, i);
  Event rezero;
  rezero.kind = Event::Kind::kDepthRezero;
  rezero.utc = Utc(45.03);
  rezero.has_value = true;
  rezero.value_m = 540;
  ASSERT_FALSE(track.Push(rezero));
  DepthGrid grid(track);
  for (int i = 0; i <= 1100; ++i) {
    const UtcTime node = Utc(i * 0.1);
    EXPECT_EQ(grid.At(node).known, track.At(node).known) << i;
    EXPECT_NEAR(grid.At(node).md, track.At(node).md, 1e-9) << i;
  }
  for (const double about : {30.0, 45.0, 60.0, 70.0, 100.0}) {
    for (double t = about - 0.3; t < about + 0.3; t += 0.0013) {
      const AlongHole coarse = grid.At(Utc(t)), fine = track.At(Utc(t));
      ASSERT_EQ(coarse.known, fine.known) << t;
      ASSERT_NEAR(coarse.md, fine.md, 0.02) << t;
    }
  }
}

TEST(DepthGrid, OrderAndDensityOfTheQuestionsDoNotMatter) {
  DepthTrack track;
  for (int i = 0; i <= 300; ++i) Push(track, i * 0.1, Swinging(i * 0.1), i);
  DepthGrid dense(track);
  for (double t = 3; t < 25; t += 0.003) {
    const AlongHole a = dense.At(Utc(t));
    DepthGrid fresh(track);
    const AlongHole b = fresh.At(Utc(t));
    ASSERT_EQ(a.md, b.md);
    ASSERT_EQ(a.speed, b.speed);
    ASSERT_EQ(a.acceleration, b.acceleration);
  }
}

TEST(DepthGrid, OfABlockIsThatOfItsInstants) {
  DepthTrack track;
  for (int i = 0; i <= 200; ++i) Push(track, i * 0.1, Swinging(i * 0.1), i);
  // From where depth is unknown into it, across its cells and out of it again.
  for (const double begin : {-0.05, 1.01, 7.0, 19.95}) {
    DepthGrid one(track), many(track);
    std::vector<UtcTime> utc;
    for (int i = 0; i < 60; ++i) utc.push_back(Utc(begin + 0.0043 * i));
    AlongHoleBlock block, moving;
    many.At(utc, DepthGrid::Asks::kAll, block);
    many.At(utc, DepthGrid::Asks::kSpeed, moving);
    for (std::size_t i = 0; i < utc.size(); ++i) {
      const AlongHole a = one.At(utc[i]), b = block.At(i);
      EXPECT_EQ(a.known, b.known) << begin << " " << i;
      EXPECT_EQ(a.md, b.md) << begin << " " << i;
      EXPECT_EQ(a.speed, b.speed) << begin << " " << i;
      EXPECT_EQ(a.acceleration, b.acceleration) << begin << " " << i;
      EXPECT_EQ(a.sigma_md, b.sigma_md) << begin << " " << i;
      EXPECT_EQ(a.sigma_speed, b.sigma_speed) << begin << " " << i;
      EXPECT_EQ(a.sigma_acceleration, b.sigma_acceleration) << begin << " " << i;
      const AlongHole speed = moving.At(i);
      EXPECT_EQ(a.known, speed.known) << begin << " " << i;
      EXPECT_EQ(a.md, speed.md) << begin << " " << i;
      EXPECT_EQ(a.speed, speed.speed) << begin << " " << i;
      EXPECT_EQ(a.sigma_speed, speed.sigma_speed) << begin << " " << i;
    }
  }
}

}  // namespace
}  // namespace wellgyro
