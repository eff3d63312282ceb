#include "wellgyro/depth/clock_tie.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

constexpr std::int64_t kUtc0 = 1'700'000'000'123'456'000;
constexpr std::int64_t kTool0 = 987'654'321'012;

/// A tool clock with a drift, read in batches: the first sample of a batch carries the surface's
/// UTC with its jitter, the others follow at the nominal period, as bus/ makes them.
struct Clocks {
  double drift = 20e-6, jitter = 0, period = 0.01, walk = 0;
  int batch = 100;
  std::int64_t step_ns = 0, step_at = std::numeric_limits<std::int64_t>::max();
  Random random{7};

  double wander = 0;

  std::int64_t True(std::int64_t tool_ns) const {
    const double d = drift * static_cast<double>(tool_ns) + wander * 1e9;
    return tool_ns + std::llround(d) + (tool_ns >= step_at ? step_ns : 0);
  }
  template <class Each>
  void Run(ClockTie& tie, double seconds, Each each, std::int64_t from = 0) {
    const auto period_ns = Duration::Seconds(period).ns;
    const auto n = static_cast<std::int64_t>(seconds / period);
    std::int64_t begin = 0, utc = 0;
    for (std::int64_t k = 0; k < n; ++k) {
      const std::int64_t tool = from + k * period_ns;
      wander += walk * std::sqrt(period) * random.Normal();
      if (k % batch == 0) {
        begin = tool;
        utc = (True(tool) + std::llround(jitter * 1e9 * random.Normal())) / 1000 * 1000;
      }
      SampleStamp stamp;
      stamp.tool_time = {kTool0 + tool};
      stamp.utc = {kUtc0 + utc + (tool - begin)};
      stamp.session = 3;
      tie.Push(stamp);
      each(tool);
    }
  }
};

TEST(ClockTie, DriftAndOffsetOverDaysToMicroseconds) {
  ClockTie tie;
  Clocks clocks{.drift = -35e-6, .period = 0.1, .batch = 10};
  double worst = 0;
  clocks.Run(tie, 3 * 86400, [&](std::int64_t tool) {
    if (tool < 600'000'000'000) return;
    const auto error = tie.ToUtc({kTool0 + tool}).ns - (kUtc0 + clocks.True(tool));
    worst = std::max(worst, std::abs(static_cast<double>(error)) * 1e-9);
  });
  EXPECT_LT(worst, 2e-6);
  EXPECT_NEAR(tie.drift(), -35e-6, 1e-8);
  EXPECT_FALSE(tie.doubtful());
  EXPECT_EQ(tie.steps(), 0);
}

// Normalised errors of 40 clocks at the end of an hour: mean square inside the 99.9 % band of
// chi-square with 40 degrees of freedom, [16.9, 76.1] / 40; batches of a second, so that the
// jitter of a second's pairs is one draw.
TEST(ClockTie, SigmaIsHonestUnderJitterThatItMustLearn) {
  for (const double jitter : {0.3e-3, 2e-3, 15e-3}) {
    double nees = 0, nees_drift = 0;
    for (int seed = 0; seed < 40; ++seed) {
      ClockTie tie({.walk_drift = 1e-9});
      Clocks clocks{.drift = 12e-6, .jitter = jitter, .period = 0.05, .batch = 20};
      clocks.random = Random(static_cast<std::uint64_t>(seed));
      std::int64_t last = 0;
      clocks.Run(tie, 3600, [&](std::int64_t tool) { last = tool; });
      const auto error =
          static_cast<double>(tie.ToUtc({kTool0 + last}).ns - kUtc0 - clocks.True(last)) * 1e-9;
      nees += std::pow(error / tie.Sigma({kTool0 + last}), 2) / 40;
      nees_drift += std::pow((tie.drift() - 12e-6) / tie.sigma_drift(), 2) / 40;
    }
    EXPECT_GT(nees, 16.9 / 40) << jitter;
    EXPECT_LT(nees, 76.1 / 40) << jitter;
    EXPECT_GT(nees_drift, 0.1) << jitter;  // the walk allowed for is not there
    EXPECT_LT(nees_drift, 76.1 / 40) << jitter;
  }
}

TEST(ClockTie, AStepOfUtcIsFollowedWithinSecondsAndCounted) {
  for (const double step : {-0.8, 1.0, 3600.0, 1.6e9}) {
    ClockTie tie;
    Clocks clocks{.jitter = 1e-3};
    clocks.step_at = 200'000'000'000;
    clocks.step_ns = Duration::Seconds(step).ns;
    bool doubted = false;
    clocks.Run(tie, 230, [&](std::int64_t tool) {
      if (tool > clocks.step_at) doubted = doubted || tie.doubtful();
    });
    const std::int64_t last = 229'000'000'000;
    EXPECT_NEAR(
        static_cast<double>(tie.ToUtc({kTool0 + last}).ns - kUtc0 - clocks.True(last)) * 1e-9, 0,
        3e-3)
        << step;
    EXPECT_EQ(tie.steps(), 1) << step;
    EXPECT_TRUE(doubted) << step;
    EXPECT_FALSE(tie.doubtful()) << step;
  }
}

TEST(ClockTie, SingleOutliersMoveNothing) {
  ClockTie tie;
  Clocks clocks{.jitter = 0.5e-3};
  clocks.Run(tie, 300, [](std::int64_t) {});
  SampleStamp stamp;
  stamp.session = 3;
  for (int k = 0; k < 100; ++k) {
    stamp.tool_time = {kTool0 + 300'000'000'000 + k * 10'000'000};
    stamp.utc = {kUtc0 + clocks.True(300'000'000'000) + 400'000'000 + k * 10'000'000};
    tie.Push(stamp);
  }
  clocks.Run(
      tie, 5, [](std::int64_t) {}, 301'000'000'000);
  const std::int64_t last = 305'000'000'000;
  EXPECT_NEAR(static_cast<double>(tie.ToUtc({kTool0 + last}).ns - kUtc0 - clocks.True(last)) * 1e-9,
              0, 1e-3);
  EXPECT_EQ(tie.steps(), 0);
}

// Jitter that grows a hundredfold is neither a step nor a reason to stand still.
TEST(ClockTie, GrowingJitterIsLearnt) {
  ClockTie tie;
  Clocks clocks{.jitter = 0.1e-3};
  clocks.Run(tie, 1200, [](std::int64_t) {});
  const double before = tie.Sigma({kTool0 + 1'200'000'000'000});
  clocks.jitter = 10e-3;
  clocks.Run(
      tie, 1200, [](std::int64_t) {}, 1'200'000'000'000);
  const std::int64_t last = 2'399'000'000'000;
  const double error =
      static_cast<double>(tie.ToUtc({kTool0 + last}).ns - kUtc0 - clocks.True(last)) * 1e-9;
  EXPECT_GT(tie.Sigma({kTool0 + last}), 3 * before);
  EXPECT_LT(tie.Sigma({kTool0 + last}), 3e-3) << "the mean of many pairs of 10 ms";
  EXPECT_LT(std::abs(error), 4 * tie.Sigma({kTool0 + last}));
}

TEST(ClockTie, UnsyncedPairsWeighLittleAndAreDoubted) {
  ClockTie tie;
  Clocks clocks{.jitter = 0};
  clocks.Run(tie, 300, [](std::int64_t) {});
  SampleStamp stamp;
  stamp.session = 3;
  stamp.utc_unsynced = true;
  for (std::int64_t k = 0; k < 9000; ++k) {
    const std::int64_t tool = 300'000'000'000 + k * 10'000'000;
    stamp.tool_time = {kTool0 + tool};
    stamp.utc = {kUtc0 + clocks.True(tool) + 50'000'000};  // 50 ms wrong
    tie.Push(stamp);
  }
  EXPECT_TRUE(tie.doubtful());
  const std::int64_t last = 389'990'000'000;
  EXPECT_NEAR(static_cast<double>(tie.ToUtc({kTool0 + last}).ns - kUtc0 - clocks.True(last)) * 1e-9,
              0, 2e-3);
}

// Every sample alone, or batches of a second: the same clock, to the rounding of UTC.
TEST(ClockTie, BatchSizeDoesNotMatter) {
  UtcTime ends[3];
  int i = 0;
  for (const int batch : {1, 10, 300}) {
    ClockTie tie;
    Clocks clocks{.drift = 50e-6, .batch = batch};
    clocks.Run(tie, 600, [](std::int64_t) {});
    ends[i++] = tie.ToUtc({kTool0 + 600'000'000'000});
  }
  EXPECT_LT(std::abs((ends[0] - ends[1]).seconds()), 1e-6);
  EXPECT_LT(std::abs((ends[0] - ends[2]).seconds()), 1e-6);
}

TEST(ClockTie, ClocksInPerfectStepAreTiedToo) {
  ClockTie tie;
  Clocks clocks{.drift = 0};
  clocks.Run(tie, 3600, [](std::int64_t) {});
  EXPECT_EQ(tie.ToUtc({kTool0 + 3600'000'000'000}).ns, kUtc0 + 3600'000'000'000);
  EXPECT_LT(tie.Sigma({kTool0 + 3600'000'000'000}), 1e-3);
  EXPECT_FALSE(tie.doubtful());
}

TEST(ClockTie, ANewSessionStartsAfreshAndOldTimesAreIgnored) {
  ClockTie tie;
  EXPECT_FALSE(tie.known());
  Clocks clocks;
  clocks.Run(tie, 100, [](std::int64_t) {});
  SampleStamp stamp;
  stamp.session = 3;
  stamp.tool_time = {kTool0};
  stamp.utc = {kUtc0 + 5'000'000'000};
  tie.Push(stamp);
  EXPECT_NEAR(static_cast<double>(tie.ToUtc({kTool0}).ns - kUtc0), 0, 1e6);
  stamp.session = 4;
  stamp.tool_time = {0};
  tie.Push(stamp);
  EXPECT_EQ(tie.ToUtc({0}).ns, stamp.utc.ns);
  EXPECT_EQ(tie.session(), 4);
}

TEST(ClockTie, NonsenseTimesDoNotOverflow) {
  ClockTie tie;
  SampleStamp stamp;
  constexpr auto kMin = std::numeric_limits<std::int64_t>::min();
  constexpr auto kMax = std::numeric_limits<std::int64_t>::max();
  for (const auto& [tool, utc] : {std::pair{kMin, kMax}, std::pair{std::int64_t{0}, kMin},
                                  std::pair{std::int64_t{5'000'000'000}, kMax},
                                  std::pair{kMax - 1, kMin}, std::pair{kMax, kMax}}) {
    stamp.tool_time = {tool};
    stamp.utc = {utc};
    tie.Push(stamp);
    (void)tie.ToUtc({tool});
  }
  EXPECT_TRUE(tie.known());
  EXPECT_THROW(ClockTie({.sigma_pair = 0}), std::invalid_argument);
}

/// Five times from `time` on, by `many` at once.
void ExpectTimesOf(const ClockTie& one, const ClockTie& many, ToolTime time, Duration period) {
  std::vector<UtcTime> times(5);
  many.ToUtc(time, period, times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_EQ(times[i].ns, one.ToUtc(time).ns);
    time = time + period;
  }
}

TEST(ClockTie, FollowingTakesWhatPushWouldToTheBit) {
  constexpr std::int64_t kPeriod = 3'000'000;
  ClockTie one, many;
  Random random(4);
  std::size_t followed = 0;
  std::int64_t utc = kUtc0;
  SampleStamp stamp;
  stamp.session = 1;
  for (std::int64_t k = 0; k < 20'000;) {
    const auto n = static_cast<std::size_t>(1 + 80 * random.Uniform());
    // Now and then the surface says nothing new.
    if (random.Uniform() < 0.7) utc += std::llround(1e5 * random.Normal());
    for (std::size_t i = 0; i < n;) {
      const auto stand = [&](std::size_t j) {
        stamp.tool_time = {kTool0 + (k + static_cast<std::int64_t>(j)) * kPeriod};
        stamp.utc = {utc + (k + static_cast<std::int64_t>(j)) * kPeriod};
      };
      stand(i);
      one.Push(stamp);
      many.Push(stamp);
      const std::size_t more = many.Follow(stamp.tool_time, Duration{kPeriod}, n - i - 1);
      for (std::size_t j = i + 1; j <= i + more; ++j) {
        stand(j);
        one.Push(stamp);
        ASSERT_EQ(one.ToUtc(stamp.tool_time).ns, many.ToUtc(stamp.tool_time).ns);
      }
      followed += more;
      i += 1 + more;
    }
    k += static_cast<std::int64_t>(n);
    ASSERT_EQ(one.drift(), many.drift());
    ASSERT_EQ(one.Sigma(stamp.tool_time), many.Sigma(stamp.tool_time));
    ExpectTimesOf(one, many, stamp.tool_time, Duration{kPeriod});
  }
  EXPECT_GT(followed, 15'000u);
}

}  // namespace
}  // namespace wellgyro
