#include "wellgyro/depth/passes.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

UtcTime At(double seconds) { return {1'600'000'000'000'000'000 + Duration::Seconds(seconds).ns}; }

struct Seen {
  Pass pass;
  int number;
  double begin, end;  // monotone depths
};

/// Walks through the depths at 0.1 m per step and lists the passes.
std::vector<Seen> Walk(PassTracker& tracker, std::initializer_list<double> turns) {
  std::vector<Seen> passes;
  double md = *turns.begin(), t = 0;
  const auto push = [&] {
    const PassState state = tracker.Push(At(t += 0.1), md);
    if (state.begins) passes.push_back({state.pass, state.number, state.md, state.md});
    EXPECT_EQ(passes.back().number, state.number);
    const bool out = state.pass == Pass::kOut;
    EXPECT_GE((state.md - passes.back().end) * (out ? -1 : 1), 0);
    passes.back().end = state.md;
  };
  for (const double turn : turns) {
    const int steps = static_cast<int>(std::lround(std::abs(turn - md) / 0.1));
    for (int i = 0; i < steps; ++i) {
      md += turn > md ? 0.1 : -0.1;
      push();
    }
    md = turn;
    for (int i = 0; i < 30; ++i) push();
  }
  return passes;
}

TEST(Passes, InOutRepeatAndOnwards) {
  PassTracker tracker({.reversal = 2, .first_move = 0.15});
  const auto passes = Walk(tracker, {1000, 1100, 1099, 1200, 1150, 1180, 1120, 1300, 1000});
  const std::vector<Seen> expected = {
      {Pass::kStationary, 1, 1000, 1000}, {Pass::kIn, 2, 1000.2, 1200},
      {Pass::kOut, 3, 1198, 1150},        {Pass::kRepeat, 4, 1152, 1180},
      {Pass::kOut, 5, 1178, 1120},        {Pass::kRepeat, 6, 1122, 1200},
      {Pass::kIn, 7, 1200, 1300},         {Pass::kOut, 8, 1298, 1000},
  };
  ASSERT_EQ(passes.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(passes[i].pass, expected[i].pass) << i;
    EXPECT_EQ(passes[i].number, expected[i].number) << i;
    EXPECT_NEAR(passes[i].begin, expected[i].begin, 0.1001) << i;
    EXPECT_NEAR(passes[i].end, expected[i].end, 0.1001) << i;
  }
}

TEST(Passes, TheTurnIsNamed) {
  PassTracker tracker;
  UtcTime turn;
  for (int i = 0; i <= 1000; ++i) tracker.Push(turn = At(i), 500 + 0.1 * i);
  for (int i = 1; i <= 30; ++i) tracker.Push(At(1000 + i), 600 - 0.1 * i);
  EXPECT_EQ(tracker.state().pass, Pass::kOut);
  EXPECT_EQ(tracker.state().utc_turn, turn);
  EXPECT_NEAR(tracker.state().md_turn, 600, 1e-9);
}

TEST(Passes, AStandstillIsStationaryAndItsNoiseIsNoMotion) {
  PassTracker tracker;
  for (int i = 0; i < 1000; ++i) tracker.Push(At(i), 2500 + (i % 7 == 0 ? 0.02 : 0));
  EXPECT_EQ(tracker.state().pass, Pass::kStationary);
  EXPECT_EQ(tracker.state().number, 1);
}

// A tool logged upwards from the bottom: the first way down afterwards covers nothing again.
TEST(Passes, OutFirst) {
  PassTracker tracker({.reversal = 2, .first_move = 0.15});
  const auto passes = Walk(tracker, {3000, 2000, 2500});
  ASSERT_EQ(passes.size(), 3u);
  EXPECT_EQ(passes[1].pass, Pass::kOut);
  EXPECT_EQ(passes[2].pass, Pass::kIn);
}

TEST(Passes, ANewDepthScaleBeginsAPassOfTheSameKind) {
  PassTracker tracker;
  for (int i = 0; i < 100; ++i) tracker.Push(At(i), i);
  tracker.Restart();
  const PassState state = tracker.Push(At(100), 50);
  EXPECT_TRUE(state.begins);
  EXPECT_EQ(state.pass, Pass::kIn);
  EXPECT_EQ(state.number, 3);
  EXPECT_EQ(state.md, 50);
  EXPECT_EQ(tracker.Push(At(101), 51).pass, Pass::kIn);
}

TEST(Passes, RefusesASetUpThatCannotBe) {
  EXPECT_THROW(PassTracker({.reversal = 0.05, .first_move = 0.1}), std::invalid_argument);
  EXPECT_THROW(PassTracker({.reversal = 2, .first_move = 0}), std::invalid_argument);
}

TEST(PassTracker, OfABlockIsThatOfItsDepthsWherePlain) {
  PassTracker one, many;
  std::vector<UtcTime> utc;
  std::vector<double> md;
  for (int i = 0; i < 6000; ++i) {
    // Stands, goes in by fits and starts, out, over again, and with the depth's own noise.
    const double t = 0.01 * i, way = t < 5 ? 0 : t < 25 ? t - 5 : t < 35 ? 45 - t : t - 25;
    utc.push_back(At(t));
    md.push_back(100 + way + 0.02 * std::sin(9 * t));
  }
  int plain = 0, single = 0;
  for (std::size_t at = 0; at < md.size();) {
    const std::size_t n = std::min<std::size_t>(md.size() - at, 1 + at % 13);
    const std::span<const double> depths(md.data() + at, n);
    for (std::size_t i = 0; i < n; ++i) one.Push(utc[at + i], md[at + i]);
    if (many.FurthestWithin(depths)) {
      many.Push(std::span<const UtcTime>(utc.data() + at, n), depths);
      ++plain;
    } else {
      for (std::size_t i = 0; i < n; ++i) many.Push(utc[at + i], md[at + i]);
      ++single;
    }
    at += n;
    const PassState &a = one.state(), &b = many.state();
    ASSERT_EQ(a.pass, b.pass) << at;
    EXPECT_EQ(a.number, b.number) << at;
    EXPECT_EQ(a.md, b.md) << at;
    EXPECT_EQ(a.utc_turn.ns, b.utc_turn.ns) << at;
    EXPECT_EQ(a.md_turn, b.md_turn) << at;
  }
  // It stands, goes in, out, repeats, and goes on in.
  EXPECT_EQ(one.state().number, 5);
  EXPECT_GT(plain, 2 * single);
}

}  // namespace
}  // namespace wellgyro
