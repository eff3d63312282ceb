// What was not seen of the hole's turning, against holes that turn as the options say they may:
// errors over sigmas, squared and summed over seeds.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/attitude/tracker.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"

#include "attitude/tracker_truth.h"

namespace wellgyro {
namespace {

constexpr double kRate = 10;             // [Hz]
constexpr double kAccelNoise = 2e-4;     // [m/s^2 sqrt(s)]
constexpr double kDogleg = 1.7e-3;       // [rad/m]
constexpr std::int64_t kGapBegin = 200;  // sample
constexpr int kSeeds = 40;

const Site kSite = truth::SiteOf(FromDegrees(60));

/// 1 m/s and 3 rpm through a hole of one dogleg, drawn.
truth::Path Bend(Random& random) {
  const double build = kDogleg * random.Normal(), walk = kDogleg * random.Normal();
  return [build, walk](double t) {
    truth::Motion m;
    m.inclination = 0.8 + build * t;
    m.inclination_rate = build;
    m.azimuth = 1 + walk / std::sin(0.8) * t;
    m.azimuth_rate = walk / std::sin(0.8);
    m.toolface = 0.3 + 0.1 * kPi * t;
    m.toolface_rate = 0.1 * kPi;
    m.md = 100 + t;
    m.speed = 1;
    return m;
  };
}

TrackerOptions Options() {
  TrackerOptions options;
  options.accel_noise = kAccelNoise;
  options.unseen.dogleg = kDogleg;
  return options;
}

/// Pushes samples [begin, end) of the path with the accelerometers' noise, `change` first.
void Play(HighSideTracker& tracker, const truth::Path& path, std::int64_t begin, std::int64_t end,
          Random& random, const std::function<void(ImuSample&)>& change = {}) {
  for (std::int64_t k = begin; k < end; ++k) {
    ImuSample sample = truth::SampleAt(path, {}, kSite, k, kRate);
    for (double& f : sample.f_T) f += kAccelNoise * std::sqrt(kRate) * random.Normal();
    const double middle = (static_cast<double>(k) + 0.5) / kRate;
    tracker.SetAzimuth(path(middle).azimuth);
    if (change) change(sample);
    ASSERT_TRUE(tracker.Push(sample, truth::AlongAt(path, middle), kSite));
  }
}

void ExpectHonest(double sum, int count, const char* what) {
  EXPECT_GT(sum, ChiSquareQuantile(0.001, count)) << what << " of " << count;
  EXPECT_LT(sum, ChiSquareQuantile(0.999, count)) << what << " of " << count;
}

class Gaps : public ::testing::TestWithParam<int> {};

// Its length in samples; the inclination is asked for when so much has been seen behind it.
TEST_P(Gaps, InclinationBehindIsAsGoodAsItSays) {
  const std::int64_t behind = kGapBegin + GetParam();
  double soon = 0, later = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Random random(seed);
    const truth::Path path = Bend(random);
    HighSideTracker tracker(Options());
    Play(tracker, path, 0, kGapBegin, random);
    const auto off = [&](std::int64_t from, std::int64_t to) {
      Play(tracker, path, from, to, random);
      tracker.Flush();
      const Knot knot = tracker.CutKnot();
      const double truth = path(static_cast<double>(to) / kRate).inclination;
      return std::pow((knot.inclination - truth) / knot.sigma_inclination, 2);
    };
    soon += off(behind, behind + 10);
    later += off(behind + 10, behind + 50);
  }
  ExpectHonest(soon, kSeeds, "a second behind");
  ExpectHonest(later, kSeeds, "five seconds behind");
}

INSTANTIATE_TEST_SUITE_P(Samples, Gaps, ::testing::Values(1, 5, 30, 600));

/// The whole path's turning less what `see` lets a tracker see of it, over the knot's own sigma.
double UnseenSquares(std::int64_t end,
                     const std::function<void(HighSideTracker&, const truth::Path&, Random&)>& see,
                     Quality flag) {
  double sum = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Random random(seed), again(seed);
    const truth::Path path = Bend(random);
    Bend(again);
    HighSideTracker all(Options()), some(Options());
    Play(all, path, 0, end, random);
    see(some, path, again);
    all.Flush();
    some.Flush();
    const Knot full = all.CutKnot(), knot = some.CutKnot();
    EXPECT_TRUE(Has(knot.quality, flag));
    EXPECT_EQ(full.var_unseen, 0);
    const double sine = std::sin(0.8);
    sum += (std::pow(full.lift - knot.lift, 2) + std::pow(sine * (full.turn - knot.turn), 2)) /
           knot.var_unseen;
  }
  return sum;
}

// In a hole that goes on as it does, the second of two gaps hides more of the same.
TEST(Unseen, InTwoGapsIsAsMuchAsTheySay) {
  const double sum = UnseenSquares(
      500,
      [](HighSideTracker& tracker, const truth::Path& path, Random& random) {
        Play(tracker, path, 0, 200, random);
        Play(tracker, path, 230, 300, random);
        Play(tracker, path, 330, 500, random);
      },
      Quality::kGap);
  ExpectHonest(sum, 2 * kSeeds, "two gaps");
}

// So little can the gyros read that nearly all the hole's turning is beyond it.
TEST(Unseen, BeyondFullScaleIsAsMuchAsItSays) {
  static constexpr double kFullScale = 2e-5;  // [rad/s]
  const double sum = UnseenSquares(
      400,
      [](HighSideTracker& tracker, const truth::Path& path, Random& random) {
        Play(tracker, path, 0, 400, random, [](ImuSample& sample) {
          if (sample.stamp.seq < 100 || sample.stamp.seq >= 300) return;
          for (int axis : {0, 1}) {
            double& w = sample.w_IT_T[axis];
            sample.stamp.gyro_saturated |= std::abs(w) > kFullScale;
            w = std::clamp(w, -kFullScale, kFullScale);
          }
        });
      },
      Quality::kSaturated);
  ExpectHonest(sum, 2 * kSeeds, "saturated");
}

TEST(Unseen, AGapIsTheSameInPieces) {
  Random random(1), again(1);
  const truth::Path path = Bend(random);
  Bend(again);
  HighSideTracker whole(Options()), pieces(Options());
  Play(whole, path, 0, 200, random);
  Play(whole, path, 260, 300, random);
  Play(pieces, path, 0, 200, again);
  EXPECT_THROW(pieces.CutGap(Duration::Seconds(1)), std::invalid_argument);
  Play(pieces, path, 260, 261, again);
  EXPECT_THROW(pieces.CutGap(Duration::Seconds(6.1)), std::invalid_argument);
  const Knot first = pieces.CutGap(Duration::Seconds(2));
  EXPECT_NEAR(first.seconds, 22, 1e-9);
  EXPECT_NEAR(first.gap_seconds, 2, 1e-9);
  EXPECT_EQ(first.time.ns, 22'000'000'000);
  EXPECT_TRUE(Has(first.quality, Quality::kGap));
  const Knot second = pieces.CutGap(Duration::Seconds(6));
  EXPECT_NEAR(second.seconds, 4, 1e-9);
  EXPECT_NEAR(second.gap_seconds, 4, 1e-9);
  EXPECT_EQ(second.turn, 0);
  EXPECT_GT(second.sigma_inclination, first.sigma_inclination);
  EXPECT_THROW(pieces.CutGap(Duration::Seconds(5)), std::invalid_argument);
  Play(pieces, path, 261, 300, again);
  whole.Flush();
  pieces.Flush();
  const Knot all = whole.CutKnot(), last = pieces.CutKnot();
  EXPECT_NEAR(first.seconds + second.seconds + last.seconds, all.seconds, 1e-9);
  EXPECT_NEAR(first.turn + last.turn, all.turn, 1e-12);
  EXPECT_NEAR(first.lift + last.lift, all.lift, 1e-12);
  EXPECT_NEAR(first.var_unseen + second.var_unseen, all.var_unseen, 1e-9 * all.var_unseen);
  EXPECT_NEAR(all.var_unseen, std::pow(6 * kDogleg, 2), 1e-6 * all.var_unseen);
  EXPECT_EQ(last.samples_lost, 60);
  EXPECT_EQ(last.gap_seconds, 0);
  EXPECT_EQ(last.inclination, all.inclination);
}

// What the tool turned by in a gap no gyro felt, so that their misalignment took no part in it.
TEST(Unseen, ARollInAGapIsNoSensitivity) {
  truth::Path path = [](double t) {
    truth::Motion m;
    m.inclination = 0.8;
    m.azimuth = 1;
    m.toolface = t < 23 ? 0.3 : 1.8;
    m.md = 100;
    return m;
  };
  Random random(1);
  HighSideTracker tracker(Options());
  Play(tracker, path, 0, 200, random);
  tracker.Flush();
  tracker.CutKnot();
  Play(tracker, path, 260, 280, random);
  tracker.Flush();
  const Knot knot = tracker.CutKnot();
  EXPECT_NEAR(knot.roll, 1.5, 0.01);
  EXPECT_LT(std::hypot(knot.d_lift[Knot::kMisalignmentX], knot.d_lift[Knot::kMisalignmentY]), 0.01);
}

}  // namespace
}  // namespace wellgyro
