// The inclination's sigma where the depth scatters, through the track and the grid of depths.
#include "wellgyro/attitude/level_noise.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/attitude/tracker.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/depth/depth_grid.h"
#include "wellgyro/depth/depth_track.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"

#include "attitude/tracker_truth.h"

namespace wellgyro {
namespace {

constexpr double kSpeed = 0.5, kRate = 10, kSeconds = 62;
constexpr double kAccelNoise = 1e-4, kWalk = 3e-6;
constexpr int kSeeds = 60;
/// The first while the marks of the first window are all there is, the last in the steady state.
constexpr std::array<double, 6> kStations{0.1, 1, 3, 8, 20, 60};

UtcTime Utc(double seconds) { return {1'700'000'000'000'000'000 + Duration::Seconds(seconds).ns}; }

struct Case {
  double inclination_deg, scatter, marks_hz;
};

truth::Path Straight(double inclination_deg) {
  return [inclination = FromDegrees(inclination_deg)](double t) {
    truth::Motion m;
    m.inclination = inclination;
    m.azimuth = 1;
    m.toolface = 0.3;
    m.md = 100 + kSpeed * t;
    m.speed = kSpeed;
    return m;
  };
}

/// Marks from `begin` on.
DepthTrack Marks(const Case& c, double begin, Random& random) {
  DepthTrack track;
  for (int i = 0; begin + i / c.marks_hz < kSeconds + 10; ++i) {
    const double t = begin + i / c.marks_hz;
    DepthMark mark;
    mark.utc = Utc(t);
    mark.seq = i;
    mark.md = 100 + kSpeed * t + c.scatter * random.Normal();
    EXPECT_FALSE(track.Push(mark));
  }
  return track;
}

std::vector<Knot> KnotsAt(const std::vector<ImuSample>& clean, const DepthTrack& track,
                          Random& random) {
  TrackerOptions options;
  options.accel_noise = kAccelNoise;
  options.angle_random_walk = kWalk;
  HighSideTracker tracker(options);
  tracker.SetAzimuth(1);
  DepthGrid grid(track);
  const Site site = truth::SiteOf(1);
  std::vector<Knot> knots;
  for (ImuSample sample : clean) {
    for (int i = 0; i < 3; ++i) sample.f_T(i) += kAccelNoise * std::sqrt(kRate) * random.Normal();
    for (int i = 0; i < 2; ++i) sample.w_IT_T(i) += kWalk * std::sqrt(kRate) * random.Normal();
    const UtcTime middle = sample.stamp.utc + Duration::Seconds(0.5 / kRate);
    tracker.Push(sample, grid.At(middle), site);
    if (!tracker.ready() || knots.size() == kStations.size()) continue;
    if (1e-9 * static_cast<double>(tracker.time().ns) < kStations[knots.size()] - 1e-6) continue;
    knots.push_back(tracker.CutKnot());
  }
  return knots;
}

class ScatteringDepth : public ::testing::TestWithParam<Case> {};

// Marks that scatter so that accelerations are beyond what the tracker trusts make sigma up to
// twice too large for some seconds: see LevelNoise.
TEST_P(ScatteringDepth, IsInTheSigmaOfTheInclination) {
  const Case& c = GetParam();
  const double truth = FromDegrees(c.inclination_deg);
  std::vector<ImuSample> clean;
  clean.reserve(static_cast<std::size_t>(kSeconds * kRate));
  for (int k = 0; k < kSeconds * kRate; ++k) {
    clean.push_back(truth::SampleAt(Straight(c.inclination_deg), {}, truth::SiteOf(1), k, kRate));
  }
  for (const double begin : {-10.0, 0.0}) {  // of the marks, before the run or with it
    std::array<double, kStations.size()> level{}, accel{};
    for (int seed = 1; seed <= kSeeds; ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      const std::vector<Knot> knots = KnotsAt(clean, Marks(c, begin, random), random);
      ASSERT_EQ(knots.size(), kStations.size());
      for (std::size_t k = 0; k < knots.size(); ++k) {
        const Knot& knot = knots[k];
        level[k] += std::pow((knot.inclination - truth) / knot.sigma_inclination, 2);
        accel[k] += std::pow((knot.inclination_accel - truth) / knot.sigma_inclination_accel, 2);
      }
    }
    std::printf("%2.0f deg, %.0f cm at %2.0f Hz:", c.inclination_deg, 100 * c.scatter, c.marks_hz);
    const double high = ChiSquareQuantile(1 - 1e-3, kSeeds);
    for (std::size_t k = 0; k < kStations.size(); ++k) {
      std::printf(" %.2f/%.2f", level[k] / kSeeds, accel[k] / kSeeds);
      EXPECT_LT(level[k], high) << "inclination after " << kStations[k] << " s: " << level[k];
      EXPECT_LT(accel[k], high) << "accelerometers' after " << kStations[k] << " s: " << accel[k];
      if (begin == 0) continue;  // at the first mark no acceleration is told, but every doubt
      EXPECT_GT(level[k], 0.25 * kSeeds) << "inclination after " << kStations[k] << " s";
      EXPECT_GT(accel[k], 0.25 * kSeeds) << "accelerometers' after " << kStations[k] << " s";
    }
    std::printf("\n");
  }
}

INSTANTIATE_TEST_SUITE_P(Holes, ScatteringDepth,
                         ::testing::Values(Case{5, 0.01, 4}, Case{5, 0.03, 4}, Case{45, 0.01, 4},
                                           Case{45, 0.03, 4}, Case{85, 0.01, 4}, Case{85, 0.03, 4},
                                           Case{85, 0.01, 1}, Case{85, 0.03, 10}));

// An acceleration that errs as the derivative of a speed: of its mean the two ends are left, and
// over a short time it is itself.
TEST(LevelNoise, OfAMeanOfAccelerationsTheEndsAreLeft) {
  const AlongHole along{.known = true, .sigma_speed = 0.01, .sigma_acceleration = 0.02};
  EXPECT_NEAR(LevelNoise::MeanVariance(along, along, 1e-3), 4e-4, 1e-6);
  // The integral's speed errs by 1.2185 as much as the fitted one.
  EXPECT_NEAR(LevelNoise::MeanVariance(along, along, 1000) * 1e6, 2 * std::pow(0.012185, 2), 1e-9);
  EXPECT_EQ(LevelNoise::MeanVariance({}, {}, 1), 0);
}

}  // namespace
}  // namespace wellgyro
