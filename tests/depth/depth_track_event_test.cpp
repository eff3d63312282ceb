#include <gtest/gtest.h>

#include "wellgyro/depth/depth_track.h"

#include "depth/marks.h"
#include "depth/utc.h"

namespace wellgyro {
namespace {

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

}  // namespace
}  // namespace wellgyro
