#include "wellgyro/plan/expected_end.h"

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/math/rotation.h"
#include "wellgyro/plan/preflight.h"
#include "wellgyro/plan/stop_information.h"
#include "wellgyro/plan/stop_stand.h"
#include "wellgyro/plan/synthetic_run.h"

#include "plan/cases.h"

namespace wellgyro {
namespace {

/// A tool of white noise alone that is moved as fast as may be: what it knows, one stop told it.
PlanCase NoiseAlone(double inclination, double azimuth, double latitude) {
  PlanCase c = test::CaseOf({{0, inclination, azimuth}, {20, inclination, azimuth}}, latitude, 0);
  c.gyro = {.angle_random_walk = 0.005 * units::kDegPerSqrtHour};
  c.errors = {.gyro_bias_sigma = 1e-6 * units::kDegPerHour, .accel_noise = 1e-5};
  c.way.speed_in = 10;
  c.way.speed_out = 0;
  return c;
}

// 2026-11-25: shear and the axes of z were not among what the plan knows of accelerometers, and the
// gyros' misalignment was taken to be known five times as well as it is.
TEST(SyntheticRun, ErrorsOfAccelerometersMoveTheForceAsTheirReadingsWould) {
  using Eigen::Vector3d;
  const PlanCase c = test::CaseOf({{0, 60, 40}, {200, 60, 40}}, 60, 3);
  const SyntheticRun run(c, {}, SetupOfPlan(c));
  const Increment& inc = run.knots()[5].increment;
  const double roll = inc.roll_before + inc.roll_after;
  ASSERT_GT(std::abs(roll), 0.5);
  const std::pair<ErrorSource, Vector3d (*)(const Vector3d&)> readings[] = {
      {kAccelBiasX, [](const Vector3d&) { return Vector3d(1, 0, 0); }},
      {kAccelBiasY, [](const Vector3d&) { return Vector3d(0, 1, 0); }},
      {kAccelScaleX, [](const Vector3d& f) { return Vector3d(f.x(), 0, 0); }},
      {kAccelScaleY, [](const Vector3d& f) { return Vector3d(0, f.y(), 0); }},
      {kAccelScaleZ, [](const Vector3d& f) { return Vector3d(0, 0, f.z()); }},
      {kAccelMisalignmentX, [](const Vector3d& f) { return Vector3d(f.z(), 0, 0); }},
      {kAccelMisalignmentY, [](const Vector3d& f) { return Vector3d(0, f.z(), 0); }},
      {kAccelShear, [](const Vector3d& f) { return Vector3d(f.y(), f.x(), 0); }},
      {kAccelMisalignmentZX, [](const Vector3d& f) { return Vector3d(0, 0, f.x()); }},
      {kAccelMisalignmentZY, [](const Vector3d& f) { return Vector3d(0, 0, f.y()); }}};
  for (const auto& [source, reading] : readings) {
    // Of T at each instant, turned to M: the mean over the knot, by the midpoint rule.
    constexpr int kParts = 2000;
    Vector3d mean = Vector3d::Zero();
    for (int i = 0; i < kParts; ++i) {
      const double psi = roll * ((i + 0.5) / kParts - 0.5);
      mean += RotationZ(psi) * reading(RotationZ(-psi) * inc.force_M) / kParts;
    }
    EXPECT_LT((inc.ForceBy(source) - mean).norm(), 1e-6) << source;
    EXPECT_GT(mean.norm(), 0.1) << source;
  }
}

// sigma_A = N / (sqrt(D) Omega cos L |across|): the Earth's rate about the east, (cos A, sin A cos
// I) of it across the tool.
TEST(ExpectedEnd, OneStopFindsNorthAsTheEarthsRateAcrossTheToolAllows) {
  for (const double inclination : {20., 60., 90.}) {
    for (const double azimuth : {0., 50., 140.}) {
      const double latitude = 60, seconds = 600;
      const PlanCase c = NoiseAlone(inclination, azimuth, latitude);
      const ExpectedEnd end =
          ExpectEnd(c, std::vector<PlannedStop>{{false, 0, seconds, {}}}, false);
      ASSERT_TRUE(end.solved);
      const double A = azimuth * units::kDeg, I = inclination * units::kDeg;
      const double across = std::hypot(std::cos(A), std::sin(A) * std::cos(I));
      const double sigma = c.gyro.angle_random_walk / std::sqrt(seconds) /
                           (kEarthRate * std::cos(latitude * units::kDeg) * across);
      EXPECT_NEAR(end.sigma_azimuth / sigma, 1, 0.03) << inclination << " " << azimuth;
    }
  }
}

// An azimuth told moves the end across by itself times the horizontal reach.
TEST(ExpectedEnd, AToldAzimuthTurnsTheWellAboutItsBegin) {
  PlanCase c = NoiseAlone(90, 30, 60);
  c.sigma_start_azimuth = 0.01 * units::kDeg;  // better than the Earth's rate in two seconds
  const ExpectedEnd end = ExpectEnd(c, {}, false);
  EXPECT_NEAR(end.semi_major, 2.4477 * 20 * *c.sigma_start_azimuth, 0.02 * end.semi_major);
  EXPECT_NEAR(std::remainder(end.azimuth_major - 120 * units::kDeg, kPi), 0, 0.02);
}

// A told azimuth turns each place about the begin: across the hole it is off by its way times the
// sine of the inclination times that.
TEST(ExpectedEnd, AlongTheWayATurnGrowsWithTheWay) {
  PlanCase c = NoiseAlone(40, 70, 55);
  c.sigma_start_azimuth = 0.01 * units::kDeg;
  c.way.speed_in = 1;  // knots of 4 m
  const std::vector<ExpectedPlace> places = ExpectAlong(c, {}, 5);
  ASSERT_EQ(places.size(), 4u);
  const Eigen::Vector3d across(-std::sin(70 * units::kDeg), std::cos(70 * units::kDeg), 0);
  for (const ExpectedPlace& place : places) {
    const double sigma = place.md * std::sin(40 * units::kDeg) * *c.sigma_start_azimuth;
    const double said = std::sqrt(across.dot(place.cov_p_WT_W * across));
    EXPECT_NEAR(said / sigma, 1, 0.02) << place.md;
  }
  EXPECT_NEAR(places.back().md, 20, 1e-9);
  const ExpectedEnd end = ExpectEnd(c, {}, false);
  EXPECT_LT((places.back().cov_p_WT_W - end.cov_p_WT_W).norm(), 1e-9 * end.cov_p_WT_W.norm());
  EXPECT_THROW(ExpectAlong(c, {}, 0), std::invalid_argument);
}

TEST(ExpectedEnd, DepthStandsAlongTheHoleAndThePath) {
  // 1000 m north, a quarter of a turn of 100 m, 1000 m east.
  const double bend = 50 * kPi, reach = 1100;
  PlanCase c = test::CaseOf(
      {{0, 90, 0}, {1000, 90, 0}, {1000 + bend, 90, 90}, {2000 + bend, 90, 90}}, 60, 0);
  c.errors.depth_sigma = 0.5;
  // Where the tool is, off by 0.5 m north; and the hole at that depth, by as much west beside that.
  EXPECT_NEAR(DepthCovariance(c)(0, 0), 0.5, 1e-9);
  EXPECT_NEAR(DepthCovariance(c)(1, 1), 0.25, 1e-9);
  // A scale lengthens the way to the tool; the hole at that depth is back along it.
  c.errors.depth_sigma = 0;
  c.errors.depth_scale_sigma = 1e-3;
  const Eigen::Matrix3d cov = DepthCovariance(c);
  const double back = 1e-3 * (2000 + bend), path = 1e-3 * reach;
  EXPECT_NEAR(cov(0, 0), 2 * path * path, 1e-3);
  EXPECT_NEAR(cov(1, 1), path * path + (path - back) * (path - back), 1e-3);
}

// The matrices that a search works on against the whole run put through the estimator.
TEST(StopInformation, SaysOfStopsWhatTheWholeRunDoes) {
  for (PlanCase c : {test::Slant(), test::SShape(), test::Horizontal()}) {
    c.way.speed_in = c.way.speed_out = 2;
    const StopInformation info(c, PlacesEvery(c.way, 150));
    ASSERT_TRUE(info.solved());
    StopStand stand(info, 5, HUGE_VAL);
    EXPECT_NEAR(stand.Value().ellipse / ExpectEnd(c, {}, false).semi_major, 1, 1e-3);
    std::vector<PlannedStop> stops;
    for (const std::size_t i : {std::size_t{1}, std::size_t{5}, info.places() / 2 + 4}) {
      stops.push_back({info.place(i).out, info.place(i).md, 200, {}});
      stand.Add({i, 0, 200});
      // What the gyros drift in the stops' own time is left out there.
      EXPECT_NEAR(stand.Value().ellipse / ExpectEnd(c, stops, false).semi_major, 1, 0.03);
    }
    // Taken back, all is as before; and a stop's own worth is what it changed.
    const double before = stand.Value().ellipse;
    const StopStand::Rest last = stand.stops()[2];
    const double without = stand.ValueWith({last.place, 0, -200}).ellipse;
    stand.Add({last.place, 0, -200});
    EXPECT_EQ(stand.stops().size(), 2u);
    EXPECT_NEAR(stand.Value().ellipse, without, 1e-6 * without);
    stand.Add({last.place, 0, 200});
    EXPECT_NEAR(stand.Value().ellipse, before, 1e-6 * before);
  }
}

// A tool that slides too: it is turned back, and goes on as the search took it to.
TEST(StopInformation, ATurnBeforeAStopIsWhatTheWholeRunSays) {
  for (PlanCase c : {test::Slant(), test::SShape()}) {
    c.way.speed_in = c.way.speed_out = 2;
    const StopInformation info(c, PlacesEvery(c.way, 90));
    const std::size_t i = 3;
    std::vector<PlannedStop> stops{{false, info.place(0).md, 200, {}}};
    for (const double turn : {0., 1.5, 3.1}) {
      stops.resize(1);
      stops.push_back({false, info.place(i).md, 200, info.place(i).toolface + turn});
      StopStand stand(info, 5, HUGE_VAL);
      stand.Add({0, 0, 200});
      stand.Add({i, turn, 200});
      // What the gyros drift in the stops' own time is left out there.
      EXPECT_NEAR(stand.Value().ellipse / ExpectEnd(c, stops, false).semi_major, 1, 0.03) << turn;
    }
  }
}

TEST(PlanCase, RefusesWhatMakesNoSense) {
  const auto why = [](PlanCase c, std::vector<PlannedStop> stops = {}) {
    try {
      CheckPlanCase(c, stops);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  PlanCase c = test::Slant();
  EXPECT_EQ(why(c), "");
  c.way.end_md = 9000;
  EXPECT_NE(why(c).find("end_md must lie in the well, 300 to 3000 m, is 9000"), std::string::npos);
  c = test::Slant();
  c.way.speed_in = NAN;
  EXPECT_NE(why(c).find("speed_in"), std::string::npos);
  c = test::Slant();
  c.gyro.angle_random_walk = 0;
  EXPECT_NE(why(c).find("angle_random_walk"), std::string::npos);
  c = test::Slant();
  EXPECT_NE(why(c, {{false, 100, 60, {}}}).find("stop.md"), std::string::npos);
  c.way.speed_out = 0;
  EXPECT_NE(why(c, {{true, 400, 60, {}}}).find("way up"), std::string::npos);
}

TEST(Preflight, SaysWhatMakesAWellHard) {
  PlanCase c = test::CaseOf({{0, 0, 90}, {600, 0, 90}, {1500, 90, 90}, {2500, 90, 90}}, 78, 0);
  c.gyro.rate_random_walk = 1 * units::kDegPerHourSqrtHour;
  c.errors.time_skew_sigma = 0;
  ExpectedEnd end;
  end.seconds = 7200;
  end.semi_major = 10;
  const auto said = Preflight(c, end, {.at_surface = 10, .gradient = 0.1, .calibrated_to = 100});
  std::string all;
  for (const std::string& s : said) all += s + "\n";
  for (const char* word : {"latitude 78.0", "east-west", "within 1 deg of vertical", "walks by",
                           "time skew", "degC"}) {
    EXPECT_NE(all.find(word), std::string::npos) << word << "\n" << all;
  }
  const PlanCase easy = test::Slant();
  const UtcTime day{86'400'000'000'000}, later{40 * day.ns};
  const auto dated = [&](const PreflightDates& dates) {
    const auto texts = Preflight(easy, end, {}, dates);
    return texts.empty() ? std::string() : texts.back();
  };
  using testing::HasSubstr;
  EXPECT_THAT(dated({.expires = day}), HasSubstr("has an end: --date"));
  EXPECT_THAT(dated({.expires = day, .run = later}), HasSubstr("runs out 39 days before"));
  EXPECT_THAT(dated({.calibrated = later, .run = day}), HasSubstr("39 days after the run"));
  EXPECT_THAT(dated({.calibrated = day, .run = later}), HasSubstr("39 days old and states no end"));
  EXPECT_THAT(dated({.calibrated = day, .expires = later, .run = day}),
              Not(HasSubstr("calibration")));
  for (const std::string& s : Preflight(easy, ExpectEnd(easy, {}, false), {})) {
    EXPECT_NE(s.find("no error of"), std::string::npos) << s;  // depth has none in this case
  }
}

}  // namespace
}  // namespace wellgyro
