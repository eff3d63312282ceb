#include "wellgyro/base/time.h"

#include <cstdint>
#include <limits>
#include <type_traits>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

template <class A, class B>
concept Subtractable = requires(A a, B b) {
  a - b;
};

TEST(Time, TheTwoClocksDoNotMix) {
  static_assert(Subtractable<ToolTime, ToolTime>);
  static_assert(!Subtractable<ToolTime, UtcTime>);
  static_assert(!std::is_convertible_v<ToolTime, UtcTime>);
}

TEST(Time, SecondsBeyondWhatNanosecondsHoldAreTheLongest) {
  constexpr Duration kLongest{std::numeric_limits<std::int64_t>::max()};
  constexpr Duration kLeast{std::numeric_limits<std::int64_t>::min()};
  EXPECT_EQ(Duration::Seconds(1e300), kLongest);
  EXPECT_EQ(Duration::Seconds(9.3e9), kLongest);
  EXPECT_EQ(Duration::Seconds(-std::numeric_limits<double>::infinity()), kLeast);
  EXPECT_EQ(Duration::Seconds(std::numeric_limits<double>::quiet_NaN()), kLeast);
  EXPECT_EQ(Duration::Seconds(-1.5).ns, -1'500'000'000);
}

TEST(Time, DifferencesAreExactOverYears) {
  const UtcTime a{1'700'000'000'000'000'001};
  const UtcTime b = a + Duration{365LL * 86400 * 1'000'000'000};
  EXPECT_EQ((b - a).ns, 365LL * 86400 * 1'000'000'000);
  EXPECT_EQ(Duration::Seconds(-0.25).ns, -250'000'000);
}

}  // namespace
}  // namespace wellgyro
