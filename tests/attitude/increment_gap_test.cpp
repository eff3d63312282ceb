#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/attitude/increment_builder.h"
#include "wellgyro/base/angle.h"

#include "attitude/tool_motion.h"
#include "simulate/allocation_count.h"

namespace wellgyro {
namespace {

using motion::Attitude;
using motion::InHole;
using motion::Turning;

IncrementOptions GapOptions() {
  IncrementOptions options;
  options.accel_noise = 5e-4;
  return options;
}

std::vector<ImuSample> Steady(double rate, double seconds, bool has_gz = false) {
  return motion::Samples(InHole(40, Turning(3)), {.has_gz = has_gz}, rate, seconds);
}

// Everything an increment says, bit for bit.
bool Same(const Increment& a, const Increment& b) {
  return std::memcmp(&a.time, &b.time, sizeof a.time) == 0 && a.seconds == b.seconds &&
         a.roll_before == b.roll_before && a.roll_after == b.roll_after && a.turn_M == b.turn_M &&
         a.turn_before_M == b.turn_before_M && a.force_M == b.force_M &&
         a.turn_per_roll == b.turn_per_roll && a.force_per_roll == b.force_per_roll &&
         a.turn_by_error == b.turn_by_error && a.force_by_error == b.force_by_error &&
         a.var_turn == b.var_turn && a.sigma_roll == b.sigma_roll && a.seq_begin == b.seq_begin &&
         a.seq_end == b.seq_end && a.quality == b.quality;
}

TEST(IncrementKnots, DoNotDependOnOtherKnotsOrOnWhenTheyAreFetched) {
  const auto samples = Steady(20, 40);
  IncrementBuilder often(GapOptions()), seldom(GapOptions());
  std::vector<Increment> a, b;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    often.Push(samples[k], false);
    seldom.Push(samples[k], false);
    if (k % 20 == 9) often.Cut(0.25);
    if (k % 20 == 19) often.Cut();
    if (k % 20 == 19) seldom.Cut();
    if (k % 20 == 19 && k % 60 != 59) seldom.Ready();
    while (often.Ready()) a.push_back(often.Pop());
  }
  often.Flush();
  seldom.Flush();
  while (often.Ready()) a.push_back(often.Pop());
  while (seldom.Ready()) b.push_back(seldom.Pop());
  ASSERT_EQ(a.size(), 80u);
  ASSERT_EQ(b.size(), 40u);
  for (std::size_t k = 0; k < b.size(); ++k) {
    // Two halves compose to the whole.
    const Eigen::Matrix3d halves = motion::Turned(a[2 * k], 0) * motion::Turned(a[2 * k + 1], 0);
    EXPECT_LT((halves - motion::Turned(b[k], 0)).norm(), 1e-9);
    EXPECT_EQ(a[2 * k + 1].time, b[k].time);
    EXPECT_EQ(a[2 * k].seq_begin, b[k].seq_begin);
    EXPECT_EQ(a[2 * k + 1].seq_end, b[k].seq_end);
  }
  const auto again = motion::Increments(samples, 1, GapOptions());
  ASSERT_EQ(again.size(), b.size());
  for (std::size_t k = 0; k < b.size(); ++k) EXPECT_TRUE(Same(again[k], b[k])) << k;
}

// What was given away as the last stays what it was when more comes after all.
TEST(IncrementKnots, StayWhatTheyWereWhenSamplesFollowAFlush) {
  const auto samples = Steady(20, 30);
  IncrementBuilder at_once(GapOptions()), late(GapOptions());
  std::vector<Increment> a, b;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    at_once.Push(samples[k], false);
    late.Push(samples[k], false);
    if (k % 20 == 13) {
      at_once.Cut();
      late.Cut();
    }
    if (k == 313) {
      at_once.Flush();
      late.Flush();
    }
    while (at_once.Ready()) a.push_back(at_once.Pop());
  }
  at_once.Flush();
  late.Flush();
  while (at_once.Ready()) a.push_back(at_once.Pop());
  while (late.Ready()) b.push_back(late.Pop());
  ASSERT_EQ(a.size(), 30u);
  ASSERT_EQ(b.size(), a.size());
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_TRUE(Same(a[k], b[k])) << k;
}

// A sample a nanosecond off its time is looked at more closely than one that is right behind the
// one before, and summed to the same. The last of each second, where knots are cut, is on time.
TEST(IncrementKnots, AreTheSameByAClockThatJitters) {
  const auto even = Steady(1000, 30);
  auto jittering = even;
  for (std::size_t k = 0; k < even.size(); k += 4) ++jittering[k].stamp.tool_time.ns;
  const auto a = motion::Increments(even, 1, GapOptions());
  const auto b = motion::Increments(jittering, 1, GapOptions());
  ASSERT_EQ(a.size(), 30u);
  ASSERT_EQ(b.size(), a.size());
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_TRUE(Same(a[k], b[k])) << k;
}

TEST(IncrementKnots, AllocateNothingOnTheWay) {
  const auto samples = Steady(20, 60);
  IncrementBuilder builder(GapOptions());
  const long before = AllocationCount();
  double seconds = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    builder.Push(samples[k], k % 100 < 20);
    if (k % 7 == 0) builder.Cut(0.5);
    while (builder.Ready()) seconds += builder.Pop().seconds;
  }
  EXPECT_EQ(AllocationCount(), before);
  EXPECT_GT(seconds, 40);
}

TEST(IncrementKnots, SayWhichSamplesTheyAreMadeOf) {
  const auto samples = Steady(20, 3);
  IncrementBuilder builder(GapOptions());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    builder.Push(samples[k], false);
    if (k == 10) {
      builder.Cut(0.5);
      builder.Cut(0.75);  // a knot within one sample
      EXPECT_THROW(builder.Cut(0.75), std::invalid_argument);
      EXPECT_THROW(builder.Cut(0.5), std::invalid_argument);
    }
  }
  EXPECT_FALSE(builder.Ready());
  EXPECT_THROW(builder.Pop(), std::logic_error);
  EXPECT_THROW(builder.Cut(0), std::invalid_argument);
  EXPECT_THROW(builder.Cut(1.5), std::invalid_argument);
  builder.Cut();
  builder.Flush();
  ASSERT_TRUE(builder.Ready());
  const Increment first = builder.Pop(), within = builder.Pop(), rest = builder.Pop();
  EXPECT_FALSE(builder.Ready());
  EXPECT_NEAR(first.seconds, 0.525, 1e-9);
  EXPECT_NEAR(within.seconds, 0.0125, 1e-9);
  EXPECT_NEAR(rest.seconds, 3 - 0.5375, 1e-9);
  EXPECT_EQ(first.seq_begin, 0);
  EXPECT_EQ(first.seq_end, 11);
  EXPECT_EQ(within.seq_begin, 10);
  EXPECT_EQ(within.seq_end, 11);
  EXPECT_EQ(rest.seq_begin, 10);
  EXPECT_EQ(rest.seq_end, 60);
  EXPECT_EQ(rest.time.ns, 3'000'000'000);
  EXPECT_EQ(rest.quality, Quality::kGood);
  EXPECT_TRUE(rest.level);
  EXPECT_TRUE(rest.roll_seen);
}

TEST(IncrementKnots, BridgeAGap) {
  for (const bool has_gz : {false, true}) {
    const auto samples = Steady(20, 40, has_gz);
    const Attitude attitude = InHole(40, Turning(3));
    IncrementBuilder builder(GapOptions());
    std::vector<Increment> increments;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      if (k >= 412 && k < 450) continue;  // 20.6 to 22.5 s
      ASSERT_TRUE(builder.Push(samples[k], false));
      if (k == 450) {
        EXPECT_THROW(builder.CutGap(Duration::Seconds(2.1)), std::invalid_argument);
        builder.CutGap(Duration::Seconds(0.4));
        builder.CutGap(Duration::Seconds(1.4));
      }
      if (k % 20 == 19) builder.Cut();
    }
    builder.Flush();
    while (builder.Ready()) increments.push_back(builder.Pop());
    ASSERT_EQ(increments.size(), 40u);
    double t = 0;
    for (std::size_t k = 0; k < increments.size(); ++k) {
      const Increment& i = increments[k];
      double delta = 0;
      const double miss = motion::Miss(i, attitude, t, delta).norm();
      t += i.seconds;
      EXPECT_NEAR(static_cast<double>(i.time.ns) * 1e-9, t, 1e-9);
      const bool touched = k >= 20 && k <= 22;
      // The hole's bending itself changes by 5e-5 rad/s within two seconds.
      EXPECT_LT(miss, touched ? 1e-4 : 1e-9) << k;
      EXPECT_LT(std::abs(delta), touched ? 2e-3 : 1e-4) << k;
      EXPECT_EQ(Has(i.quality, Quality::kGap), touched) << k;
      EXPECT_NEAR(i.gap_seconds, k == 20 ? 0.4 : k == 21 ? 1 : k == 22 ? 0.5 : 0, 1e-9) << k;
      EXPECT_EQ(i.samples_lost, k == 22 ? 38 : 0) << k;
      EXPECT_EQ(i.level, k != 21) << k;
      EXPECT_EQ(i.has_axial, has_gz && !touched) << k;
    }
  }
}

TEST(IncrementKnots, GoOnInANewSession) {
  auto samples = Steady(20, 30);
  for (std::size_t k = 300; k < samples.size(); ++k) {
    samples[k].stamp.session = 2;
    samples[k].stamp.tool_time.ns -= 14'000'000'000;  // another clock
    samples[k].stamp.seq -= 290;
  }
  const Attitude attitude = InHole(40, Turning(3));
  IncrementBuilder builder(GapOptions());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    ASSERT_TRUE(builder.Push(samples[k], false));
    if (k % 20 == 9) builder.Cut();
  }
  builder.Flush();
  double t = 0;
  while (builder.Ready()) {
    const Increment i = builder.Pop();
    double delta = 0;
    EXPECT_LT(motion::Miss(i, attitude, t, delta).norm(), 1e-8) << t;
    t += i.seconds;
  }
  EXPECT_NEAR(t, 29.5, 1e-9);
}

TEST(IncrementKnots, RefuseWhatCannotBeASample) {
  auto samples = Steady(20, 1);
  IncrementBuilder builder(GapOptions());
  EXPECT_THROW(builder.Cut(), std::invalid_argument);
  EXPECT_THROW(builder.CutGap(Duration{1}), std::invalid_argument);
  for (const ImuSample& s : samples) ASSERT_TRUE(builder.Push(s, false));
  EXPECT_FALSE(builder.Push(samples[5], false));  // late
  EXPECT_FALSE(builder.Push(samples.back(), false));
  ImuSample next = samples.back();
  next.stamp.tool_time.ns += next.stamp.period_ns;
  ++next.stamp.seq;
  ImuSample bad = next;
  bad.f_T.z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(builder.Push(bad, false));
  bad = next;
  bad.stamp.period_ns = 0;
  EXPECT_FALSE(builder.Push(bad, false));
  EXPECT_TRUE(builder.Push(next, false));
  for (const double wrong : {-1., std::numeric_limits<double>::infinity()}) {
    IncrementOptions options;
    options.accel_noise = wrong;
    EXPECT_THROW(IncrementBuilder{options}, std::invalid_argument);
  }
}

TEST(IncrementKnots, SayWhatStoodAtFullScale) {
  auto samples = Steady(20, 30);
  samples[204].stamp.accel_saturated = true;
  samples[204].f_T.setConstant(1);
  samples[404].stamp.gyro_saturated = true;
  const auto increments = motion::Increments(samples, 1, GapOptions());
  ASSERT_EQ(increments.size(), 30u);
  for (std::size_t k = 0; k < increments.size(); ++k) {
    EXPECT_EQ(Has(increments[k].quality, Quality::kSaturated), k == 10 || k == 20) << k;
    EXPECT_NEAR(increments[k].gap_seconds, k == 20 ? 0.05 : 0, 1e-12) << k;
    EXPECT_TRUE(increments[k].level) << k;
    EXPECT_EQ(increments[k].roll_seen, k != 10) << k;
    EXPECT_LT((increments[k].force_M.norm() - motion::kGravity), 1e-4) << k;
  }
}

// A knot nobody ends ends by itself: memory stays what it is.
TEST(IncrementKnots, EndByThemselvesAfterSomeTime) {
  const auto samples = Steady(20, 100);
  IncrementBuilder builder(GapOptions());
  std::vector<Increment> increments;
  for (const ImuSample& s : samples) {
    builder.Push(s, false);
    while (builder.Ready()) increments.push_back(builder.Pop());
  }
  ASSERT_GE(increments.size(), 3u);
  for (const Increment& i : increments) EXPECT_NEAR(i.seconds, 20, 0.1);
}

// Samples lost all the time make a block of every sample.
TEST(IncrementKnots, HoldOutWhereEverySecondSampleIsLost) {
  const auto samples = Steady(20, 10);
  IncrementBuilder builder(GapOptions());
  long fetched = 0;
  for (std::int64_t k = 0; k < 100'000; ++k) {
    ImuSample s = samples[0];
    s.stamp.period_ns = 100'000;
    s.stamp.seq = 2 * k;
    s.stamp.tool_time.ns = 200'000 * k;
    ASSERT_TRUE(builder.Push(s, false));
    for (; builder.Ready(); ++fetched) builder.Pop();
  }
  EXPECT_GT(fetched, 50);
}

}  // namespace
}  // namespace wellgyro
