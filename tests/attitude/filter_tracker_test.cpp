#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/attitude/filter.h"
#include "wellgyro/attitude/smoother.h"
#include "wellgyro/attitude/tracker.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"

#include "attitude/filter_truth.h"
#include "attitude/tracker_truth.h"

// Samples to azimuth: the tracker's knots and sensitivities through the filter.
namespace wellgyro {
namespace {

constexpr double kRate = 10, kStop = 250, kGo = 450, kEnd = 900;

truth::Motion Rolling(double t) {
  const double way = t < kStop ? t : std::max(kStop, t - (kGo - kStop));
  const double moves = t < kStop || t > kGo ? 1 : 0;
  truth::Motion m;
  m.inclination = FromDegrees(40 + 4 * std::sin(way / 120));
  m.inclination_rate = moves * FromDegrees(4 * std::cos(way / 120) / 120);
  m.azimuth = FromDegrees(20 + 30 * std::sin(way / 200));
  m.azimuth_rate = moves * FromDegrees(30 * std::cos(way / 200) / 200);
  m.toolface = 0.3 + 0.02 * way;
  m.toolface_rate = moves * 0.02;
  m.md = 1000 + 0.5 * way;
  m.speed = moves * 0.5;
  return m;
}

FilterSetup Tool() {
  FilterSetup s;
  s.site = truth::SiteOf(FromDegrees(58));
  s.gyro.angle_random_walk = 0.01 * units::kDegPerSqrtHour;
  s.errors.gyro_bias_sigma = 0.1 * units::kDegPerHour;
  s.errors.mass_unbalance_sigma = 0.05 * units::kDegPerHourPerG;
  s.errors.quadrature_sigma = 0.05 * units::kDegPerHourPerG;
  s.errors.gyro_scale_sigma = 5e-4;
  s.errors.gyro_misalignment_sigma = 3e-4;
  s.errors.roll_offset_sigma = FromDegrees(0.1);
  s.errors.time_skew_sigma = 0.02;
  s.errors.accel_bias_sigma = 0.2 * units::kMilliG;
  s.errors.accel_noise = 0.05 * units::kMilliG;
  s.start_sigma = FromDegrees(0.1);
  return s;
}

Knot::SourceVector DrawErrors(const ErrorPriors& e, Random* random) {
  Knot::SourceVector sigma;
  sigma << e.gyro_bias_sigma, e.gyro_bias_sigma, e.mass_unbalance_sigma, e.quadrature_sigma,
      e.gyro_scale_sigma, e.gyro_scale_sigma, e.gyro_misalignment_sigma, e.gyro_misalignment_sigma,
      e.roll_offset_sigma, e.time_skew_sigma, e.accel_bias_sigma, e.accel_bias_sigma,
      e.accel_bias_sigma;
  for (double& s : sigma) s *= random->Normal();
  return sigma;
}

struct Flight {
  std::vector<Knot> knots;
  std::vector<truth::Motion> poses;
};

Flight Fly(const FilterSetup& setup, Random* random) {
  truth::Sensors sensors;
  sensors.error = DrawErrors(setup.errors, random);
  TrackerOptions options;
  options.accel_noise = setup.errors.accel_noise;
  options.angle_random_walk = setup.gyro.angle_random_walk;
  HighSideTracker tracker(options);
  const double n = setup.gyro.angle_random_walk * std::sqrt(kRate);
  const double a = setup.errors.accel_noise * std::sqrt(kRate);
  Flight flight;
  for (std::int64_t k = 0; k < static_cast<std::int64_t>(kEnd * kRate); ++k) {
    ImuSample s = truth::SampleAt(Rolling, sensors, setup.site, k, kRate);
    for (int i = 0; i < 2; ++i) s.w_IT_T[i] += n * random->Normal();
    for (int i = 0; i < 3; ++i) s.f_T[i] += a * random->Normal();
    const double begin = static_cast<double>(k) / kRate;
    tracker.Push(s, truth::AlongAt(Rolling, begin), setup.site);
    if (k == 0 || k % 20 != 0) continue;
    Knot knot = tracker.CutKnot();
    const double t = (knot.time - ToolTime{}).seconds();
    knot.still = t - knot.seconds > kStop + 1 && t < kGo - 1;
    flight.knots.push_back(knot);
    flight.poses.push_back(Rolling(t));
  }
  return flight;
}

double Squared(const AttitudeSample& a, const truth::Motion& truth) {
  const double d = WrapPi(a.azimuth - truth.azimuth);
  return d * d / a.cov_attitude(1, 1);
}

void ExpectInBand(const char* what, double sum, int dof) {
  EXPECT_GT(sum, ChiSquareQuantile(1e-4, dof)) << what << ": mean " << sum / dof;
  EXPECT_LT(sum, ChiSquareQuantile(1 - 1e-4, dof)) << what << ": mean " << sum / dof;
}

TEST(FilterOnTracker, AzimuthErrorsAreAsLargeAsTheyClaim) {
  constexpr int kSeeds = 60;
  double reckoned = 0, filtered = 0, smoothed = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    FilterSetup setup = Tool();
    const Flight flight = Fly(setup, &random);
    setup.start_azimuth = Rolling(0).azimuth + setup.start_sigma * random.Normal();
    AzimuthFilter filter(setup);
    std::size_t begin = 0, end = 0;
    for (std::size_t i = 0; i < flight.knots.size(); ++i) {
      filter.Step(flight.knots[i]);
      if (!flight.knots[i].still) continue;
      if (begin == 0) begin = i;
      end = i + 1;
    }
    reckoned += Squared(filter.attitude(), flight.poses.back());
    const FilterFix fix = filter.Update(
        filter_truth::FixOf(flight.knots, begin, end, setup, flight.poses[begin].azimuth));
    EXPECT_TRUE(fix.rates);
    filtered += Squared(filter.attitude(), flight.poses.back());
    const SmoothedRun run = Smooth(filter.history());
    smoothed += Squared(run.attitude[60], flight.poses[60]);
  }
  ExpectInBand("dead reckoning", reckoned, kSeeds);
  ExpectInBand("with a stop", filtered, kSeeds);
  ExpectInBand("smoothed", smoothed, kSeeds);
}

}  // namespace
}  // namespace wellgyro
