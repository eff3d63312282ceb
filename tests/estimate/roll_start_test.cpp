// Where the roll may start.
#include "wellgyro/estimate/roll_start.h"

#include <cstddef>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

// On the way only the newest knot's is asked for.
TEST(SpeedStarts, OfTheLastKnotAreThoseOfAll) {
  Random random(5);
  std::vector<RunKnot> knots(300);
  double speed = 0;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    if (k % 20 < 4) speed += 0.1 * random.Normal();
    knots[k].increment.seconds = 0.3 + 0.9 * static_cast<double>(k % 7) / 7;
    knots[k].along.known = k % 31 != 0;
    knots[k].along.speed = speed;
    knots[k].along.sigma_speed = 1e-3;
  }
  int starts = 0;
  for (std::size_t n = 1; n <= knots.size(); ++n) {
    const std::span<const RunKnot> behind = std::span(knots).first(n);
    EXPECT_EQ(LastSpeedStart(behind), SpeedStarts(behind).back()) << n;
    starts += LastSpeedStart(behind) > 0 ? 1 : 0;
  }
  EXPECT_GT(starts, 50);
  EXPECT_LT(starts, 250);
}

}  // namespace
}  // namespace wellgyro
