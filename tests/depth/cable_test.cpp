#include "wellgyro/depth/cable.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "depth/utc.h"

namespace wellgyro {
namespace {

TEST(Cable, StretchIsThatOfTheChart) {
  // 0.6 ft per 1000 ft and 1000 lbf: 12000 ft under 3500 lbf at the wheel and 1500 at the tool,
  // measured at 500: 0.6 x 12 x 2 = 14.4 ft.
  constexpr double kPound = 4.4482216152605, kFoot = 0.3048;
  Cable cable;
  cable.stretch = 0.6e-3 / (1000 * kPound);
  cable.tool_weight = 1500 * kPound;
  cable.measuring_tension = 500 * kPound;
  EXPECT_NEAR(StretchOf(cable, 12000 * kFoot, 3500 * kPound), 14.4 * kFoot, 1e-9);
  // Without a reading the cable's own weight: 2000 lbf of it.
  cable.weight = 2000 * kPound / (12000 * kFoot);
  EXPECT_NEAR(StretchOf(cable, 12000 * kFoot, {}), 14.4 * kFoot, 1e-9);
  EXPECT_EQ(StretchOf(cable, 0, {}), 0);
  // 3000 m of steel, 1.2e-5 per degree, on average 30 degrees above the shop's 15.
  Cable warm;
  warm.expansion = 1.2e-5;
  warm.gradient = 0.02;
  EXPECT_NEAR(StretchOf(warm, 3000, {}), 3000 * 1.2e-5 * 30, 1e-9);
}

TEST(Cable, AMarkThatIsCorrectedStays) {
  Cable cable;
  cable.stretch = 1e-7;
  cable.tool_weight = 5000;
  DepthMark mark;
  mark.md = 2000;
  mark.corrected = true;
  EXPECT_EQ(Stretched(cable, mark).md, 2000);
  mark.corrected = false;
  const DepthMark longer = Stretched(cable, mark);
  EXPECT_NEAR(longer.md, 2001, 1e-9);
  EXPECT_NEAR(longer.sigma.value_or(0), 0.1, 1e-9);
  mark.md = std::nan("");
  EXPECT_TRUE(std::isnan(Stretched(cable, mark).md)) << "refused later";
}

/// A counter that slips by one in a thousand, with a magnetic mark every 25 m.
struct Slipping {
  DepthTrack track;
  Cable cable;
  static double Read(double md) { return md * 0.999; }
  void Go(CableMarks& marks, double speed, double seconds, double begin) {
    std::int64_t seq = 0;
    double last = begin;
    for (double t = 0; t <= seconds; t += 0.2) {
      const double md = begin + speed * t;
      DepthMark mark;
      mark.utc = Utc(t);
      mark.seq = ++seq;
      mark.session = 1;
      mark.md = Read(md);
      EXPECT_FALSE(track.Push(mark));
      const double low = std::min(last, md), high = std::max(last, md);
      const double passed = std::ceil(low / 25) * 25;
      if (t > 0 && passed > low && passed <= high) {
        mark.magnetic_mark = true;
        mark.utc = Utc(t - 0.2 * (md - passed) / (md - last));
        marks.Push(mark);
      }
      last = md;
    }
  }
};

TEST(Cable, MagneticMarksTakeTheCountersSlipOut) {
  for (const double speed : {1.0, -1.0}) {
    Slipping run;
    run.cable.mark_spacing = 25;
    run.cable.first_mark = 0;
    CableMarks marks(run.cable, run.track);
    const double begin = speed > 0 ? 5 : 2005;
    run.Go(marks, speed, 2000, begin);
    double worst = 0, last = begin * 0.999, back = 0;
    for (double t = 1; t < 1995; t += 0.37) {
      const AlongHole along = run.track.At(Utc(t));
      ASSERT_TRUE(along.known);
      const double md = along.md + marks.At(Utc(t), along.md);
      if (t > 80) worst = std::max(worst, std::abs(md - (begin + speed * t)));
      if (t > 1) back = std::max(back, speed > 0 ? last - md : md - last);
      last = md;
    }
    EXPECT_LT(worst, 0.05) << "of 2 m; speed " << speed;
    EXPECT_LE(back, 0) << "depth stays monotone";
    EXPECT_GE(marks.passed(), 79u);
    EXPECT_NEAR(marks.largest_change(), 0.025, 0.01);
  }
}

TEST(Cable, AMarkFarOffAndOnesBeforeADepthEventDoNotCount) {
  Slipping run;
  run.cable.mark_spacing = 25;
  CableMarks marks(run.cable, run.track);
  run.Go(marks, 1, 500, 5);
  DepthMark stray;
  stray.utc = Utc(262);  // at 267 m, 8 m off
  stray.magnetic_mark = true;
  marks.Push(stray);
  EXPECT_EQ(marks.At(Utc(3), run.track.At(Utc(3)).md), 0) << "before the first mark";
  const double md = run.track.At(Utc(490)).md;
  // The first mark that passed, at 25 m, is taken as it was read.
  EXPECT_NEAR(md + marks.At(Utc(490), md), 495 - 0.025, 0.02);
  EXPECT_EQ(marks.left_out(), 1u);
  Event event;
  event.kind = Event::Kind::kDepthRezero;
  event.utc = Utc(480);
  event.has_value = true;
  event.value_m = 1000;
  EXPECT_FALSE(run.track.Push(event));
  EXPECT_EQ(marks.At(Utc(495), 1015), 0);
}

TEST(Cable, RefusesWhatMakesNoSense) {
  const DepthTrack track;
  Cable cable;
  cable.mark_spacing = -1;
  EXPECT_THROW(CableMarks(cable, track), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro
