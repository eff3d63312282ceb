#include "wellgyro/survey/run/mirrors.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/alignment/gyrocompass.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

constexpr double kBias = 0.3 * units::kDegPerHour;
constexpr double kNoise = 0.02 * units::kDegPerHour;
constexpr double kLatitude = FromDegrees(60);

struct Shot {
  double md, inclination_deg, azimuth_deg;
};

/// Builds from `first` to `end` and goes on there, a shot every 30 m.
std::vector<Shot> ShotsOf(double first, double end, double azimuth) {
  std::vector<Shot> hole;
  for (int i = 0; i < 30; ++i) {
    hole.push_back({30.0 * i, std::min(end, first + 4 * i), azimuth + 5 * std::sin(0.4 * i)});
  }
  return hole;
}

/// Shots of one tool with its one bias, made into stations.
std::vector<Draft> Shoot(const std::vector<Shot>& hole, std::uint64_t seed) {
  Random random(seed);
  const Site site = SiteAt(kLatitude, 0);
  const Eigen::Vector3d earth =
      kEarthRate * Eigen::Vector3d(std::cos(kLatitude), 0, -std::sin(kLatitude));
  const Eigen::Vector3d bias{kBias * random.Normal(), kBias * random.Normal(), 0};
  GyrocompassSetup setup;
  setup.errors.gyro_bias_sigma = kBias;
  std::vector<Draft> drafts;
  for (const Shot& shot : hole) {
    const Eigen::Matrix3d to_tool =
        AttitudeMatrix(FromDegrees(shot.azimuth_deg), FromDegrees(shot.inclination_deg), 0.4)
            .transpose();
    StillWindow window;
    window.samples = 1000;
    window.end = ToolTime{60'000'000'000};
    window.f_T = to_tool * Eigen::Vector3d(0, 0, -site.gravity);
    window.w_IT_T = to_tool * earth + bias;
    for (int i = 0; i < 2; ++i) window.w_IT_T[i] += kNoise * random.Normal();
    window.w_IT_T.z() = 0;
    window.sigma_w_IT_T.setConstant(kNoise);
    window.sigma_f_T.setConstant(1e-5);
    const NorthFix fix = Gyrocompass({&window, 1}, site, setup);
    Draft& draft = drafts.emplace_back();
    draft.station.md = shot.md;
    draft.attitude.azimuth = fix.azimuth;
    draft.attitude.inclination = fix.inclination;
    draft.attitude.cov_attitude = fix.cov_attitude;
    draft.attitude.quality = fix.quality;
    draft.mirror_azimuth = fix.mirror_azimuth;
    draft.mirror_cost = fix.mirror_cost;
  }
  return drafts;
}

struct MirrorCount {
  int wrong = 0, silent = 0, flagged = 0, all = 0;
};

/// A wrong one is nearer to the truth's mirror than to the truth.
MirrorCount Judge(const std::vector<Shot>& hole, const std::vector<Draft>& drafts) {
  MirrorCount count;
  for (std::size_t i = 0; i < hole.size(); ++i) {
    const double truth = FromDegrees(hole[i].azimuth_deg), found = drafts[i].attitude.azimuth;
    const bool wrong = std::abs(WrapPi(found - truth)) > std::abs(WrapPi(found - (kPi - truth)));
    const bool flagged = Has(drafts[i].attitude.quality, Quality::kMirror);
    ++count.all;
    count.wrong += wrong;
    count.flagged += flagged;
    count.silent += wrong && !flagged;
  }
  return count;
}

MirrorCount Many(const Job& job, const std::vector<Shot>& hole, bool resolve) {
  MirrorCount sum;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    std::vector<Draft> drafts = Shoot(hole, seed);
    if (resolve) ResolveMirrors(job, drafts);
    const MirrorCount count = Judge(hole, drafts);
    sum.wrong += count.wrong;
    sum.silent += count.silent;
    sum.flagged += count.flagged;
    sum.all += count.all;
  }
  std::printf("%s of %d stations %d at the mirror, %d flagged, %d silent\n",
              resolve ? "resolved:" : "alone:   ", sum.all, sum.wrong, sum.flagged, sum.silent);
  return sum;
}

// A shot by itself picks the mirror one time in four; a hole that builds from where there is none
// picks none.
TEST(Mirrors, AHoleThatBuildsFromASureStationHasNone) {
  for (const double end : {88.0, 90.0}) {
    const std::vector<Shot> hole = ShotsOf(40, end, 45);
    const MirrorCount alone = Many({}, hole, false), resolved = Many({}, hole, true);
    EXPECT_GT(alone.wrong, 100);
    EXPECT_EQ(alone.silent, 0);
    EXPECT_GT(alone.flagged, alone.all / 3);
    EXPECT_EQ(resolved.wrong, 0);
    // The bias has brought azimuth and mirror so close that the hole might bend from one to other.
    EXPECT_LT(resolved.flagged, resolved.all / 40);
  }
}

// All near horizontal: the shots become one hole, the right or the wrong, and all of them say so.
TEST(Mirrors, AHoleWithoutASureStationStaysFlagged) {
  for (const double inclination : {88.0, 90.0}) {
    const std::vector<Shot> hole = ShotsOf(inclination, inclination, 45);
    const MirrorCount resolved = Many({}, hole, true);
    EXPECT_GT(resolved.wrong, 0);
    EXPECT_EQ(resolved.silent, 0);
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      std::vector<Draft> drafts = Shoot(hole, seed);
      ResolveMirrors({}, drafts);
      const int wrong = Judge(hole, drafts).wrong;
      EXPECT_TRUE(wrong == 0 || wrong == static_cast<int>(hole.size())) << wrong;
    }
    Job job;
    job.tie_in.inclination = FromDegrees(inclination);
    job.tie_in.azimuth = FromDegrees(45);
    const MirrorCount tied = Many(job, hole, true);
    EXPECT_EQ(tied.wrong, 0);
    EXPECT_LT(tied.flagged, tied.all / 40);
  }
}

// Azimuth and mirror ten degrees apart: no hole tells them.
TEST(Mirrors, NeighboursTooFarAwayTellNothing) {
  std::vector<Draft> drafts(2);
  drafts[0].attitude.inclination = drafts[1].attitude.inclination = FromDegrees(89);
  drafts[0].attitude.azimuth = FromDegrees(86);
  drafts[1].station.md = 60;
  drafts[1].attitude.azimuth = FromDegrees(94);
  drafts[1].attitude.quality = Quality::kMirror;
  drafts[1].mirror_azimuth = FromDegrees(86);
  drafts[1].mirror_cost = 1;
  ResolveMirrors({}, drafts);
  EXPECT_TRUE(Has(drafts[1].attitude.quality, Quality::kMirror));
}

TEST(Mirrors, TheMirrorTakesItsCovarianceAlong) {
  std::vector<Draft> drafts(2);
  for (Draft& draft : drafts) {
    draft.attitude.inclination = FromDegrees(89);
    draft.attitude.cov_attitude << 1e-6, 2e-6, 3e-6, 2e-6, 1e-4, 4e-6, 3e-6, 4e-6, 1e-6;
  }
  drafts[0].attitude.azimuth = FromDegrees(40);
  drafts[1].station.md = 30;
  drafts[1].attitude.azimuth = FromDegrees(140);
  drafts[1].attitude.quality = Quality::kMirror | Quality::kGravity;
  drafts[1].mirror_azimuth = FromDegrees(40);
  drafts[1].mirror_cost = 4;
  ResolveMirrors({}, drafts);
  const AttitudeSample& a = drafts[1].attitude;
  EXPECT_EQ(a.quality, Quality::kGravity);
  EXPECT_NEAR(ToDegrees(a.azimuth), 40, 1e-12);
  EXPECT_EQ(a.cov_attitude(0, 1), -2e-6);
  EXPECT_EQ(a.cov_attitude(2, 1), -4e-6);
  EXPECT_EQ(a.cov_attitude(0, 2), 3e-6);
  EXPECT_EQ(drafts[1].mirror_cost, -4);
}

}  // namespace
}  // namespace wellgyro
