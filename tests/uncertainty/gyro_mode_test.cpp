#include "wellgyro/uncertainty/gyro_mode.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "wellgyro/base/units.h"

#include "cases.h"

namespace wellgyro {
namespace {

using units::kDeg;

std::vector<GyroMode> Modes(const ErrorModel& model, const std::vector<SurveyPoint>& survey) {
  GyroModeTracker tracker(model);
  tracker.Begin(survey[0]);
  std::vector<GyroMode> modes = {tracker.mode()};
  for (std::size_t k = 1; k < survey.size(); ++k) {
    tracker.Advance(survey[k - 1], survey[k]);
    modes.push_back(tracker.mode());
  }
  return modes;
}

/// Builds to 40 deg by MD 800, back to vertical by 1600, and again, every 100 m, azimuth 10 then
/// 200.
std::vector<SurveyPoint> UpAndDown() {
  return test::MadeSurvey(3200, 100, [](SurveyPoint& p) {
    const double md = std::fmod(p.md, 1600);
    p.inclination = (md <= 800 ? md : 1600 - md) / 20 * kDeg;
    p.azimuth = (p.md < 1600 ? 10 : 200) * kDeg;
    if (p.inclination < 1e-9) p.azimuth = 0;
  });
}

TEST(GyroMode, EachDropIntoTheStationaryRangeEndsASection) {
  const auto modes = Modes(test::Model("GYRO-NS-CT"), UpAndDown());  // 15 deg: above MD 300
  for (const std::size_t k : {0u, 3u, 13u, 16u, 19u, 29u, 32u}) EXPECT_EQ(modes[k].section, 0) << k;
  for (const std::size_t k : {4u, 12u}) EXPECT_EQ(modes[k].section, 1) << k;
  for (const std::size_t k : {20u, 28u}) EXPECT_EQ(modes[k].section, 2) << k;
  EXPECT_EQ(modes[13].drift_time[0], 0);
  EXPECT_NEAR(modes[4].init_azimuth, 10 * kDeg, 1e-12);
  EXPECT_NEAR(modes[20].init_azimuth, 200 * kDeg, 1e-12);
  EXPECT_NEAR(modes[20].init_inclination, 15 * kDeg, 1e-12);
}

// SPE 90408 table 7: h grows by dD / (c sin of the mean inclination); the interval of the gate
// whole.
TEST(GyroMode, DriftTimeIsTheRecursion) {
  const ErrorModel model = test::Model("GYRO-NS-CT");
  const auto modes = Modes(model, UpAndDown());
  const double c = 2743.2 / 3600;
  double drift = 0, walk = 0;
  for (std::size_t k = 4; k <= 8; ++k) {
    const double f = std::sin((2.5 + 5 * static_cast<double>(k - 1)) * kDeg);
    drift += 100 / (c * f);
    walk += 100 / (c * f * f);
    EXPECT_NEAR(modes[k].drift_time[0], drift, 1e-9 * drift);
    EXPECT_NEAR(modes[k].walk_time[0], walk, 1e-9 * walk);
  }
}

// The fix belongs to the point of the arc where the inclination is the gate's.
TEST(GyroMode, FixIsOnTheArc) {
  std::vector<SurveyPoint> survey = {{0, 10 * kDeg, 0, 0}, {30, 20 * kDeg, 40 * kDeg, 0}};
  const auto modes = Modes(test::Model("GYRO-NS-CT"), survey);
  ASSERT_EQ(modes[1].section, 1);
  // By bisection on the great circle.
  const auto t = [](double i, double a) {
    return Eigen::Vector3d(std::sin(i) * std::cos(a), std::sin(i) * std::sin(a), std::cos(i));
  };
  const Eigen::Vector3d from = t(10 * kDeg, 0), to = t(20 * kDeg, 40 * kDeg);
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double u = (low + high) / 2;
    const Eigen::Vector3d p = ((1 - u) * from + u * to).normalized();
    (std::acos(p.z()) < 15 * kDeg ? low : high) = u;
  }
  const Eigen::Vector3d p = ((1 - low) * from + low * to).normalized();
  EXPECT_NEAR(modes[1].init_azimuth, std::atan2(p.y(), p.x()), 1e-9);
}

// Model 4 of SPE 90408: z below 17 deg from the first station, xy above, each keeping what it has;
// initialised once through 3 deg, again only 2500 m on.
TEST(GyroMode, TwoZonesAndAnInitialisationOnly) {
  const ErrorModel model = test::Model("spe90408-4");
  const auto modes = Modes(model, UpAndDown());
  EXPECT_EQ(modes[0].section, 0);
  EXPECT_EQ(modes[1].section, 1);
  EXPECT_EQ(modes[16].section, 1);  // vertical again at 1600, 2500 m not gone
  EXPECT_EQ(modes[32].section, 2);  // at 3200 they are
  EXPECT_GT(modes[1].drift_time[0], 0);
  EXPECT_EQ(modes[3].drift_time[1], 0);
  EXPECT_GT(modes[4].drift_time[1], 0);
  EXPECT_EQ(modes[12].drift_time[0], modes[3].drift_time[0]);   // z rests above 17 deg
  EXPECT_GT(modes[13].drift_time[0], modes[12].drift_time[0]);  // and goes on below
  EXPECT_EQ(modes[16].drift_time[1], modes[12].drift_time[1]);
  EXPECT_EQ(modes[32].drift_time[0], 0);
}

TEST(GyroMode, ExternalReferenceOpensAtTheFirstStation) {
  const auto modes = Modes(test::Model("CB_Film_GMS"), UpAndDown());
  EXPECT_EQ(modes[0].section, 1);
  EXPECT_EQ(modes[16].section, 1);
  EXPECT_GT(modes[1].drift_time[0], 0);
}

TEST(GyroMode, RefusesWhereItsAxisFeelsNoTurn) {
  const auto survey =
      test::MadeSurvey(1000, 100, [](SurveyPoint& p) { p.inclination = p.md / 10 * kDeg; });
  const auto modes = Modes(test::Model("CB_Film_GMS"), survey);  // z: cos I
  EXPECT_TRUE(modes[8].refusal.empty());
  EXPECT_FALSE(modes[9].refusal.empty());
}

}  // namespace
}  // namespace wellgyro
