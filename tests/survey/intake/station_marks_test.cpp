#include "wellgyro/survey/intake/station_marks.h"

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

AlongHole At(double md, double speed, double sigma_speed = 0.01) {
  return {.md = md, .speed = speed, .known = true, .sigma_speed = sigma_speed};
}

ToolTime After(double seconds) { return ToolTime{} + Duration::Seconds(seconds); }

TEST(StationMarks, ARestIsMadeOnceAndAnewElsewhere) {
  StationMarks marks{Job{}};
  EXPECT_FALSE(marks.ComesToRest(At(90, 0.5), After(0)));
  EXPECT_TRUE(marks.ComesToRest(At(100, 0), After(100)));
  marks.Mark(100);
  EXPECT_FALSE(marks.ComesToRest(At(100.05, 0), After(120)));
  EXPECT_TRUE(marks.ComesToRest(At(130, 0), After(200)));
}

// Depths in whole metres rest at each of them: of an hour at 1 m/s no more than one in ten is kept.
TEST(StationMarks, DepthsThatComeToRestAtEachMarkMakeFewStations) {
  StationMarks marks{Job{}};
  int made = 0;
  for (int second = 0; second < 3600; ++second) {
    const double md = second;
    if (!marks.ComesToRest(At(md, 1, 1), After(second))) continue;
    marks.Mark(md);
    ++made;
  }
  EXPECT_LE(made, 361);
  EXPECT_GE(made, 300);
}

// A stop that begins within that time has its station none the less.
TEST(StationMarks, AStopBehindARestIsMarkedWhileItLasts) {
  StationMarks marks{Job{}};
  EXPECT_TRUE(marks.ComesToRest(At(100, 0), After(0)));
  marks.Mark(100);
  EXPECT_FALSE(marks.ComesToRest(At(102, 0), After(5)));
  EXPECT_TRUE(marks.ComesToRest(At(102, 0), After(11)));
  // The tool's clock begins anew.
  marks.Mark(102);
  EXPECT_TRUE(marks.ComesToRest(At(140, 0), After(-500)));
}

}  // namespace
}  // namespace wellgyro
