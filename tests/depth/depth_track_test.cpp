#include "wellgyro/depth/depth_track.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

#include "depth/marks.h"
#include "depth/utc.h"

namespace wellgyro {
namespace {

bool Same(const AlongHole& a, const AlongHole& b) {
  return a.md == b.md && a.speed == b.speed && a.acceleration == b.acceleration &&
         a.sigma_md == b.sigma_md && a.known == b.known;
}

TEST(DepthTrack, AConstantAccelerationIsExact) {
  std::vector<DepthMark> marks;
  const auto md = [](double t) { return 3000 - 0.3 * t + 0.05 * t * t; };
  for (int i = 0; i <= 100; ++i) marks.push_back(Mark(0.1 * i, md(0.1 * i), i));
  const DepthTrack track = Track(marks);
  for (double t = 0; t <= 10; t += 0.17) {
    const AlongHole along = track.At(Utc(t));
    EXPECT_NEAR(along.md, md(t), 1e-9);
    EXPECT_NEAR(along.speed, -0.3 + 0.1 * t, 1e-8);
    EXPECT_NEAR(along.acceleration, 0.1, 1e-7);
  }
}

TEST(DepthTrack, UnknownOutsideAndInGaps) {
  EXPECT_FALSE(DepthTrack().At(Utc(0)).known);
  EXPECT_TRUE(DepthTrack().Knows(Utc(0), Utc(5))) << "nothing came before";
  auto marks = Encoder(10, 5, [](double t) { return 100 + t; });
  for (auto mark : Encoder(10, 5, [](double t) { return 120 + t; })) {
    mark.utc = mark.utc + Duration::Seconds(20);
    mark.seq += 1000;
    marks.push_back(mark);
  }
  const DepthTrack track = Track(marks);
  EXPECT_FALSE(track.At(Utc(-0.001)).known);
  EXPECT_TRUE(track.At(Utc(0)).known);
  EXPECT_TRUE(track.At(Utc(10)).known);
  EXPECT_FALSE(track.At(Utc(10.001)).known);
  EXPECT_FALSE(track.At(Utc(15)).known);
  EXPECT_TRUE(track.At(Utc(20)).known);
  EXPECT_TRUE(track.At(Utc(30)).known);
  EXPECT_FALSE(track.At(Utc(30.001)).known);
}

TEST(DepthTrack, AStoppedToolMayKeepItsDepthThroughAGap) {
  for (const double moved : {0.0, 0.01, 0.5}) {
    auto stop = Mark(0, 700, 0);
    stop.stopped = true;
    const DepthTrack track = Track({stop, Mark(600, 700 + moved, 1), Mark(601, 700 + moved, 2)});
    const AlongHole along = track.At(Utc(596));
    EXPECT_EQ(along.known, moved < 0.02);
    if (along.known) {
      EXPECT_NEAR(along.md, 700, 0.01);
      EXPECT_NEAR(along.speed, 0, 1e-4);
    }
    EXPECT_FALSE(track.At(Utc(594)).known) << "the next mark is too far ahead to wait for";
  }
}

TEST(DepthTrack, AJumpOfTheCounterIsNoSpeed) {
  const DepthTrack track =
      Track(Encoder(60, 10, [](double t) { return (t < 30.05 ? 500 : 800) + 0.2 * t; }));
  EXPECT_FALSE(track.At(Utc(30.05)).known);
  double unknown = 0;
  for (double t = 1; t < 59; t += 0.0731) {
    const AlongHole along = track.At(Utc(t));
    if (!along.known) {
      unknown += 0.0731;
      continue;
    }
    EXPECT_NEAR(along.speed, 0.2, 0.02) << t;
    EXPECT_NEAR(along.md, (t < 30.05 ? 500 : 800) + 0.2 * t, 0.02);
  }
  EXPECT_LT(unknown, 0.2) << "between two marks";
}

// The law of interleaving: what was covered does not change, whatever comes later or out of order.
TEST(DepthTrack, WhatIsCoveredIsFinalWhateverTheOrderWithinTheLatency) {
  const auto marks = Encoder(120, 4, [](double t) { return 1000 + 0.4 * t + 0.3 * std::sin(t); });
  const auto event = DepthEvent(Event::Kind::kDepthRezero, 61.3, 500, 9);
  DepthTrack reference = Track(marks);
  EXPECT_FALSE(reference.Push(event).has_value());
  Random random(5);
  for (int trial = 0; trial < 5; ++trial) {
    // Each mark arrives up to just less than the latency late.
    std::vector<std::pair<double, DepthMark>> arrivals;
    for (std::size_t i = 0; i < marks.size(); ++i) {
      arrivals.emplace_back(0.25 * static_cast<double>(i) + 0.99 * random.Uniform(), marks[i]);
      if (random.Uniform() < 0.2) arrivals.push_back(arrivals.back());  // sent twice
    }
    std::ranges::stable_sort(arrivals, {}, [](const auto& a) { return a.first; });
    DepthTrack track;
    EXPECT_FALSE(track.Push(event).has_value());
    double asked = 0;
    for (const auto& [when, mark] : arrivals) {
      EXPECT_FALSE(track.Push(mark).has_value());
      // By now all marks of a second ago have come.
      for (; track.Knows(Utc(asked), Utc(when - 1)); asked += 0.0711) {
        EXPECT_TRUE(Same(track.At(Utc(asked)), reference.At(Utc(asked)))) << asked;
      }
      track.Forget(Utc(asked));
    }
    EXPECT_GT(asked, 118);
  }
}

TEST(DepthTrack, LateMarksAreRefusedAndRepeatedOnesSkipped) {
  DepthTrack track = Track(Encoder(10, 10, [](double t) { return 100 + t; }));
  const auto before = track.At(Utc(8.33));
  EXPECT_FALSE(track.Push(Mark(5, 0, 50)).has_value()) << "seen: same session and seq";
  EXPECT_FALSE(track.Push(Mark(9.5, 109.5, 1001)).has_value()) << "within the latency";
  const auto fault = track.Push(Mark(9, 109, 1000));
  ASSERT_TRUE(fault.has_value());
  EXPECT_EQ(fault->code, FaultCode::kLate);
  EXPECT_NE(fault->text.find("1700000009000000"), std::string::npos);
  track.Forget(Utc(8));
  EXPECT_FALSE(track.Push(Mark(1, 101, 10)).has_value()) << "forgotten, but seen";
  EXPECT_EQ(track.Push(Mark(1, 101, 0, 2))->code, FaultCode::kLate);
  EXPECT_EQ(track.Push(Mark(20, std::nan(""), 2000))->code, FaultCode::kRange);
  DepthMark never = Mark(0, 1, 3000);
  never.utc = {std::numeric_limits<std::int64_t>::max()};
  EXPECT_EQ(track.Push(never)->code, FaultCode::kRange);
  EXPECT_TRUE(track.Knows(never.utc, Utc(10))) << "whatever comes";
  EXPECT_FALSE(track.At(never.utc).known);
  EXPECT_NEAR(track.At(Utc(8.33)).md, before.md, 0.01);
}

// Depths that the log has of before and after the tool are none that it passed.
TEST(DepthTrack, TheDeepestMarkIsOfTheTimeInWhichDepthsAreNeeded) {
  DepthTrack track;
  EXPECT_FALSE(track.Deepest(Utc(0)).has_value());
  // Up from 900 m, down to 700 m, and then to 800 m.
  const auto md = [](int k) { return k < 200 ? 900 - 2.0 * k : 500 + (k - 200); };
  for (int k = 0; k < 200; ++k) EXPECT_FALSE(track.Push(Mark(0.5 * k, md(k), k)).has_value());
  EXPECT_DOUBLE_EQ(track.Deepest(Utc(100)).value_or(0), 900);
  track.NeedFrom(Utc(100));
  track.Forget(Utc(90));
  for (int k = 200; k <= 500; ++k) EXPECT_FALSE(track.Push(Mark(0.5 * k, md(k), k)).has_value());
  EXPECT_DOUBLE_EQ(track.Deepest(Utc(200)).value_or(0), 700);
  EXPECT_DOUBLE_EQ(track.Deepest(Utc(250)).value_or(0), 800);
  track.Forget(Utc(249));
  EXPECT_DOUBLE_EQ(track.Deepest(Utc(250)).value_or(0), 800);
}

TEST(DepthTrack, ATimeAtRestIsNoGapBetweenMarksThatAgree) {
  const auto at = [](std::initializer_list<DepthMark> marks, double begin, double end) {
    DepthTrack track;
    for (const DepthMark& mark : marks) EXPECT_FALSE(track.Push(mark));
    return track.AtRest(Utc(begin), Utc(end));
  };
  const DepthMark before = Mark(0, 100.005, 1), after = Mark(120, 100.015, 2);
  const AlongHole rest = at({before, after, Mark(150, 200, 3)}, 0, 120);
  ASSERT_TRUE(rest.known);
  EXPECT_NEAR(rest.md, 100.01, 1e-9);
  EXPECT_LT(rest.sigma_md, 0.01);
  EXPECT_LT(std::abs(rest.speed), 1e-3);
  // What lies outside the rest still is a gap, of 5 s at most.
  EXPECT_TRUE(at({before, after}, 2, 117.1).known);
  EXPECT_FALSE(at({before, after}, 2, 116.9).known);
  EXPECT_FALSE(at({before, after}, 60, 60).known);
  EXPECT_FALSE(at({before, Mark(120, 100.03, 2)}, 0, 120).known);
  EXPECT_FALSE(at({before}, 0, 120).known);
  // Marks within it count as well.
  EXPECT_TRUE(at({Mark(30, 100, 1), Mark(90, 100, 2)}, 0, 120).known);
}

TEST(DepthTrack, RefusesASetUpThatCannotBe) {
  EXPECT_THROW(DepthTrack({.half_window = {}}), std::invalid_argument);
  EXPECT_THROW(DepthTrack({.latency = Duration{-1}}), std::invalid_argument);
  EXPECT_THROW(DepthTrack({.sigma_md = -1}), std::invalid_argument);
}

// Cases from reports of 2026-11-21.
TEST(DepthTrack, NeverLeavesTheRangeOfItsMarks) {
  // Down to a stop just above a count, and up again.
  const auto md = [](double t) {
    return t < 60 ? 100.0033 - 0.002 * (t - 60) * (t - 60) : 100.0033;
  };
  const std::vector<DepthMark> marks = Encoder(90, 5, md);
  double deepest = 0;
  for (const DepthMark& mark : marks) deepest = std::max(deepest, mark.md);
  const DepthTrack track = Track(marks);
  for (double t = 0; t <= 90; t += 0.019) EXPECT_LE(track.At(Utc(t)).md, deepest) << t;
}

}  // namespace
}  // namespace wellgyro
