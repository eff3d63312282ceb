#include "wellgyro/base/time.h"

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

TEST(Time, DifferencesAreExactOverYears) {
  const UtcTime a{1'700'000'000'000'000'001};
  const UtcTime b = a + Duration{365LL * 86400 * 1'000'000'000};
  EXPECT_EQ((b - a).ns, 365LL * 86400 * 1'000'000'000);
  EXPECT_EQ(Duration::Seconds(-0.25).ns, -250'000'000);
}

}  // namespace
}  // namespace wellgyro
