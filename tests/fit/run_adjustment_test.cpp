#include "wellgyro/fit/run_adjustment.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "support/claims.h"
#include "support/hour.h"

namespace wellgyro {
namespace {

using testing::AzimuthError;
using testing::Claims;
using testing::ExternalJob;
using testing::Flown;
using testing::Fly;
using testing::Hour;
using testing::JobOf;
using testing::SimulationOf;

// Shorter than an hour, the same in kind.
Hour HalfHour() {
  Hour hour = testing::StrongDrift();
  hour.minutes = 30;
  hour.stop_seconds = 120;
  return hour;
}

TEST(RunAdjustment, OfAPerfectToolIsTheTruth) {
  for (const double inclination : {5., 10., 60., 90.}) {
    Hour hour = HalfHour();
    hour.inclination_deg = inclination;
    const Flown flown = Fly(hour, ExternalJob(hour, 0, 0.001), 0);
    const Adjustment adjusted = AdjustRun(flown.history, 0);
    ASSERT_TRUE(adjusted.converged);
    ASSERT_EQ(adjusted.run.attitude.size(), flown.truth.size());
    double worst_azimuth = 0, worst_inclination = 0;
    for (std::size_t i = 0; i < flown.truth.size(); ++i) {
      worst_azimuth = std::max(worst_azimuth, std::abs(AzimuthError(flown, adjusted.run, i)));
      worst_inclination =
          std::max(worst_inclination,
                   std::abs(adjusted.run.attitude[i].inclination - flown.truth[i].inclination));
    }
    EXPECT_LT(ToDegrees(worst_azimuth), 0.003) << inclination;
    EXPECT_LT(ToDegrees(worst_inclination), 2e-4) << inclination;
    EXPECT_LT(adjusted.chi_square, 1e-3 * adjusted.degrees_of_freedom) << inclination;
  }
}

// Bias, drift and g-dependent errors as in a worn tool, no azimuth from outside, one position at
// each stop: the motion itself finds north.
TEST(RunAdjustment, FindsNorthFromTheMotionAndSaysHowWell) {
  for (const double rpm : {3., 0.}) {
    Claims end, inclination;
    double smoothed_variance = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      Hour hour = testing::StrongDrift();
      hour.rpm = rpm;
      const Flown flown = Fly(hour, JobOf(hour), seed);
      const Adjustment adjusted = AdjustRun(flown.history, 0);
      ASSERT_TRUE(adjusted.converged);
      const AttitudeSample& last = adjusted.run.attitude.back();
      ASSERT_TRUE(last.azimuth_known);
      end.Add(AzimuthError(flown, adjusted.run, flown.truth.size() - 1), last.cov_attitude(1, 1));
      inclination.Add(last.inclination - flown.truth.back().inclination, last.cov_attitude(0, 0));
      smoothed_variance += Smooth(flown.history).attitude.back().cov_attitude(1, 1);
    }
    end.ExpectTrue("azimuth");
    inclination.ExpectTrue("inclination");
    EXPECT_LT(end.sigma_deg(), rpm > 0 ? 0.22 : 0.33) << rpm << " rpm";
    EXPECT_LT(3 * end.variance, smoothed_variance) << "without the lift it is far worse";
  }
}

TEST(RunAdjustment, FromAnExternalAzimuthAtTheStartIsAsGoodAsItSays) {
  Claims end, middle;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Hour hour = testing::StrongDrift();
    hour.stops = 0;
    const Flown flown = Fly(hour, ExternalJob(hour, seed, 0.001), seed);
    const Adjustment adjusted = AdjustRun(flown.history, 0);
    ASSERT_TRUE(adjusted.converged);
    const std::size_t last = flown.truth.size() - 1;
    for (const std::size_t i : {last, last / 2}) {
      (i == last ? end : middle)
          .Add(AzimuthError(flown, adjusted.run, i), adjusted.run.attitude[i].cov_attitude(1, 1));
    }
  }
  end.ExpectTrue("at the end");
  middle.ExpectTrue("half-way");
  EXPECT_LT(end.sigma_deg(), 0.2);
}

// Without a stop or an azimuth nothing but the lift knows north, and along a straight horizontal
// hole it only knows its sine.
TEST(RunAdjustment, NamesNoAzimuthWhereTheMirrorFitsAsWell) {
  Hour hour = testing::StrongDrift();
  hour.inclination_deg = 90;
  hour.swing_deg = 0;
  hour.stops = 0;
  hour.minutes = 20;
  const Flown flown = Fly(hour, JobOf(hour), 3);
  const Adjustment adjusted = AdjustRun(flown.history, 0);
  ASSERT_TRUE(adjusted.converged);
  EXPECT_TRUE(adjusted.ambiguous);
  EXPECT_FALSE(adjusted.run.attitude.back().azimuth_known);
  EXPECT_NEAR(adjusted.run.attitude.back().cov_attitude(1, 1), kPi * kPi / 3, 1e-6);
}

TEST(RunAdjustment, FindsNorthWithoutAnyStopWhereTheHoleSwings) {
  Claims end;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Hour hour = testing::StrongDrift();
    hour.stops = 0;
    const Flown flown = Fly(hour, JobOf(hour), seed);
    ASSERT_FALSE(Smooth(flown.history).attitude.back().azimuth_known);
    const Adjustment adjusted = AdjustRun(flown.history, 0);
    ASSERT_TRUE(adjusted.run.attitude.back().azimuth_known) << seed;
    end.Add(AzimuthError(flown, adjusted.run, flown.truth.size() - 1),
            adjusted.run.attitude.back().cov_attitude(1, 1));
  }
  end.ExpectTrue("azimuth");
  EXPECT_LT(end.sigma_deg(), 1);
}

TEST(RunAdjustment, OfTwoPassesIsSurerThanOfOneAndTrue) {
  Claims once, twice;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Hour hour = testing::StrongDrift();
    hour.and_back = true;
    hour.rpm = 0;
    hour.stops = 1;
    const Flown flown = Fly(hour, JobOf(hour), seed);
    const Adjustment with = AdjustRun(flown.history, 0);
    AdjustmentOptions apart;
    apart.use_repeats = false;
    const Adjustment without = AdjustRun(flown.history, 0, apart);
    const std::size_t i = flown.truth.size() / 4;
    once.Add(AzimuthError(flown, without.run, i), without.run.attitude[i].cov_attitude(1, 1));
    twice.Add(AzimuthError(flown, with.run, i), with.run.attitude[i].cov_attitude(1, 1));
  }
  once.ExpectTrue("passes apart");
  twice.ExpectTrue("passes together");
  EXPECT_LT(twice.variance, 0.97 * once.variance);
}

TEST(RunAdjustment, DoesNotDependOnHowKnotsAreMerged) {
  const Hour hour = HalfHour();
  const Flown flown = Fly(hour, ExternalJob(hour, 5, 0.1), 5);
  AdjustmentOptions fine, coarse;
  fine.knot_seconds = 3;
  coarse.knot_seconds = 10;
  const Adjustment a = AdjustRun(flown.history, 0, fine), b = AdjustRun(flown.history, 0, coarse);
  ASSERT_GT(a.run.stations.size(), 50u);
  ASSERT_EQ(a.run.stations.size(), b.run.stations.size());
  for (std::size_t i = 0; i < a.run.stations.size(); ++i) {
    const AttitudeSample &x = a.run.stations[i].attitude, &y = b.run.stations[i].attitude;
    const double sigma = std::sqrt(y.cov_attitude(1, 1));
    EXPECT_LT(std::abs(WrapPi(x.azimuth - y.azimuth)), 0.15 * sigma) << i;
    EXPECT_NEAR(std::sqrt(x.cov_attitude(1, 1)) / sigma, 1, 0.02) << i;
  }
}

TEST(RunAdjustment, FindsTheToolsErrors) {
  Claims errors;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Hour hour = HalfHour();
    hour.noise.rate_random_walk = 0;
    const Simulation simulation = SimulationOf(hour, seed);
    const Flown flown = Fly(hour, ExternalJob(hour, seed, 0.1), seed);
    const Adjustment a = AdjustRun(flown.history, 0);
    const ToolErrors& tool = simulation.tool.errors;
    const auto add = [&](Knot::Source source, double truth) {
      errors.Add(a.errors[source] - truth, a.sigma_errors[source] * a.sigma_errors[source]);
    };
    add(Knot::kGyroBiasX, tool.gyro_bias.x());
    add(Knot::kGyroBiasY, tool.gyro_bias.y());
    add(Knot::kMassUnbalance, tool.mass_unbalance);
    add(Knot::kQuadrature, tool.quadrature);
    EXPECT_LT(a.sigma_errors[Knot::kGyroBiasX], 0.2 * hour.errors.gyro_bias_sigma);
  }
  errors.ExpectTrue("errors of the tool");
}

// Of a tool that turns at 10 rpm, 0.05 s are 3 deg of toolface: to the first order alone the hole
// seems to turn by 1.4e-3 less than it does, which left 0.0064 and 0.074 deg here.
TEST(RunAdjustment, ATimeSkewMakesNoShorterTurns) {
  Hour hour = HalfHour();
  hour.inclination_deg = 20;
  hour.build_deg = 30;
  hour.rpm = 10;
  hour.errors.time_skew_sigma = 0.05;
  Simulation simulation = SimulationOf(hour, 0);
  simulation.tool.errors.time_skew = 0.05;
  Sink sink;
  const testing::KeepingAdjuster keeper;
  testing::SurveyOf(simulation, ExternalJob(hour, 0, 0.001), sink, {}, &keeper);
  const Adjustment adjusted = AdjustRun(keeper.kept, 0);
  const Truth truth(simulation);
  ASSERT_TRUE(adjusted.converged);
  double inclination = 0, azimuth = 0;
  for (std::size_t i = 0; i < keeper.kept.epochs.size(); ++i) {
    if (!keeper.kept.epochs[i].station) continue;
    const TruthState t = truth.At((keeper.kept.epochs[i].knot.time - ToolTime{}).seconds());
    const AttitudeSample& a = adjusted.run.attitude[i];
    inclination = std::max(inclination, std::abs(a.inclination - t.inclination));
    azimuth = std::max(azimuth, std::abs(WrapPi(a.azimuth - t.azimuth)));
  }
  std::printf("time skew: inclination %.5f, azimuth %.5f deg, skew %.6f s\n",
              ToDegrees(inclination), ToDegrees(azimuth), adjusted.errors[Knot::kTimeSkew]);
  EXPECT_LT(ToDegrees(inclination), 0.003);
  EXPECT_LT(ToDegrees(azimuth), 0.005);
  EXPECT_NEAR(adjusted.errors[Knot::kTimeSkew], 0.05, 2e-4);
}

TEST(RunAdjustment, OfNothingIsNothing) {
  FilterHistory history;
  history.setup.site = SiteAt(1, 0);
  EXPECT_TRUE(AdjustRun(history, 0).run.attitude.empty());
  history.epochs.emplace_back();  // says where the run begins
  history.epochs.back().knot.inclination = 0.5;
  EXPECT_EQ(AdjustRun(history, 0).run.attitude.size(), 1u);
}

TEST(RunAdjustment, WhatDoesNotFitIsLessSure) {
  const Hour hour = HalfHour();
  FilterHistory history = Fly(hour, JobOf(hour), 4).history;
  const Adjustment fits = AdjustRun(history, 0);
  double sign = 1;
  for (std::size_t i = 0; i < history.epochs.size(); i += 15, sign = -sign) {
    if (!history.epochs[i].knot.still) history.epochs[i].knot.lift += sign * 5e-4;
  }
  const Adjustment does_not = AdjustRun(history, 0);
  const double misfit = does_not.chi_square / does_not.degrees_of_freedom;
  ASSERT_GT(misfit, 2);
  EXPECT_LT(fits.chi_square, 1.2 * fits.degrees_of_freedom);
  for (const int i : {0, 1}) {
    const double grown = does_not.run.attitude.back().cov_attitude(i, i) /
                         fits.run.attitude.back().cov_attitude(i, i);
    EXPECT_NEAR(grown / misfit, 1, 0.3) << i;
    EXPECT_NEAR(
        does_not.run.stations.back().cov(i, i) / fits.run.stations.back().cov(i, i) / misfit, 1,
        0.3);
  }
}

TEST(RunAdjustment, IsSentOutByASurveyor) {
  Hour hour = HalfHour();
  Simulation simulation = SimulationOf(hour, 4);
  const LeastSquaresAdjuster adjuster;
  testing::CollectingSink sink;
  Surveyor surveyor(JobOf(hour), sink, &adjuster);
  testing::Play(simulation, surveyor);
  surveyor.Finish();
  const Survey adjusted = surveyor.Current(0);
  testing::CollectingSink other;
  const Survey smoothed = testing::SurveyOf(simulation, JobOf(hour), other);
  ASSERT_EQ(adjusted.chosen.size(), smoothed.chosen.size());
  const double variance = adjusted.chosen.back().cov_md_inc_azi(2, 2);
  EXPECT_GT(variance, 0);
  EXPECT_LT(variance, 0.5 * smoothed.chosen.back().cov_md_inc_azi(2, 2));
}

}  // namespace
}  // namespace wellgyro
