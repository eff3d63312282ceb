#include "wellgyro/depth/depth_track.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

#include "depth/utc.h"

namespace wellgyro {
namespace {

DepthMark Mark(double seconds, double md, std::int64_t seq, std::int32_t session = 1) {
  DepthMark mark;
  mark.utc = Utc(seconds);
  mark.seq = seq;
  mark.session = session;
  mark.md = md;
  return mark;
}

Event DepthEvent(Event::Kind kind, double seconds, double value, std::int32_t id) {
  Event event;
  event.kind = kind;
  event.utc = Utc(seconds);
  event.has_value = true;
  event.value_m = value;
  event.event_id = id;
  return event;
}

/// Marks of an encoder of 1 cm counts.
std::vector<DepthMark> Encoder(double seconds, double rate,
                               const std::function<double(double)>& md) {
  std::vector<DepthMark> marks;
  for (int i = 0; i <= std::lround(seconds * rate); ++i) {
    const double t = i / rate;
    marks.push_back(Mark(t, std::floor(md(t) * 100) / 100 + 0.005, i));
  }
  return marks;
}

DepthTrack Track(const std::vector<DepthMark>& marks) {
  DepthTrack track;
  for (const auto& mark : marks) EXPECT_FALSE(track.Push(mark).has_value());
  return track;
}

bool Same(const AlongHole& a, const AlongHole& b) {
  return a.md == b.md && a.speed == b.speed && a.acceleration == b.acceleration &&
         a.sigma_md == b.sigma_md && a.known == b.known;
}

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

// An operator says at 30 s that the depth is 800 m. Whether the counter was set then (it reads 800
// from there on) or not (it goes on), depths from 30 s on are the same and earlier ones stay.
TEST(DepthTrack, RezeroHoldsFromItsTimeOnWhetherOrNotTheCounterWasSet) {
  for (const bool set : {false, true}) {
    for (const bool first : {false, true}) {
      DepthTrack track;
      const auto event = DepthEvent(Event::Kind::kDepthRezero, 30, 800, 4);
      if (first) {
        EXPECT_FALSE(track.Push(event).has_value());
      }
      for (const auto& mark : Encoder(60, 10, [set](double t) {
             return (set && t >= 30 ? 800.0 - 30 * 0.2 : 500.0) + 0.2 * t;
           })) {
        EXPECT_FALSE(track.Push(mark).has_value());
      }
      if (!first) {
        EXPECT_FALSE(track.Push(event).has_value());
      }
      EXPECT_FALSE(track.Push(event).has_value()) << "sent again";
      EXPECT_NEAR(track.At(Utc(10)).md, 502, 0.01);
      EXPECT_NEAR(track.At(Utc(29.97)).md, 505.994, 0.02);
      EXPECT_NEAR(track.At(Utc(30)).md, 800, 0.01);
      EXPECT_NEAR(track.At(Utc(50)).md, 804, 0.015);
      EXPECT_NEAR(track.At(Utc(30.5)).speed, 0.2, 0.02);
      EXPECT_EQ(track.Segment(Utc(29.9)), 0);
      EXPECT_EQ(track.Segment(Utc(30)), 1);
      track.Forget(Utc(55));
      EXPECT_NEAR(track.At(Utc(55)).md, 805, 0.015);
    }
  }
}

TEST(DepthTrack, ZeroTieAndTheirSigma) {
  DepthTrack track = Track(Encoder(100, 2, [](double t) { return 12.34 + t; }));
  auto zero = DepthEvent(Event::Kind::kDepthZero, 4.2, 0, 1);
  zero.has_value = false;
  EXPECT_FALSE(track.Push(zero).has_value());
  auto tie = DepthEvent(Event::Kind::kDepthTie, 50, 51, 2);
  tie.sigma_m = 0.3;
  EXPECT_FALSE(track.Push(tie).has_value());
  EXPECT_NEAR(track.At(Utc(20)).md, 15.8, 0.02);
  EXPECT_NEAR(track.At(Utc(3)).md, 15.34, 0.02);
  EXPECT_NEAR(track.At(Utc(60)).md, 61, 0.02);
  EXPECT_LT(track.At(Utc(20)).sigma_md, 0.01);
  EXPECT_NEAR(track.At(Utc(60)).sigma_md, 0.3, 0.001);
  auto empty = DepthEvent(Event::Kind::kDepthTie, 70, 0, 3);
  empty.has_value = false;
  EXPECT_EQ(track.Push(empty)->code, FaultCode::kRange);
  EXPECT_FALSE(track.Push(DepthEvent(Event::Kind::kRemark, 70, 7, 5)).has_value());
  EXPECT_EQ(track.Segment(Utc(100)), 2);
  track.Forget(Utc(80));
  EXPECT_EQ(track.Push(DepthEvent(Event::Kind::kDepthTie, 60, 7, 6))->code, FaultCode::kLate);
}

TEST(DepthTrack, AnEventWithoutMarksAboutItMovesNothing) {
  DepthTrack track;
  EXPECT_FALSE(track.Push(DepthEvent(Event::Kind::kDepthZero, -1000, 0, 1)).has_value());
  for (const auto& mark : Encoder(20, 10, [](double t) { return 100 + t; })) {
    EXPECT_FALSE(track.Push(mark).has_value());
  }
  EXPECT_NEAR(track.At(Utc(10)).md, 110, 0.01);
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
