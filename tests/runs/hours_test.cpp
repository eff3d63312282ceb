// One-hour runs as the estimators leave them, against the truth at the same instants. Many seeds
// where WELLGYRO_LONG, few elsewhere.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/claims.h"
#include "support/hour.h"

namespace wellgyro {
namespace {

using testing::AzimuthError;
using testing::Claims;
using testing::EstimateOf;
using testing::ExternalJob;
using testing::Flown;
using testing::Fly;
using testing::Hour;
using testing::JobOf;

std::uint64_t Seeds(std::uint64_t few, std::uint64_t many) { return WELLGYRO_LONG ? many : few; }

double WorstAzimuth(const Flown& flown, const SmoothedRun& run) {
  double worst = 0;
  for (std::size_t i = 0; i < flown.truth.size(); ++i) {
    worst = std::max(worst, std::abs(AzimuthError(flown, run, i)));
  }
  return worst;
}

double WorstInclination(const Flown& flown, const SmoothedRun& run) {
  double worst = 0;
  for (std::size_t i = 0; i < flown.truth.size(); ++i) {
    worst = std::max(worst, std::abs(run.attitude[i].inclination - flown.truth[i].inclination));
  }
  return worst;
}

// Tactical gyros, and accelerometers twenty times as good: what a job says of a tool without
// errors. Of worse ones the hour at 3 deg, which comes down to 1.2, would be surveyed as a vertical
// one.
Hour Perfect() {
  Hour hour = testing::Tactical();
  hour.errors.accel_bias_sigma *= 0.05;
  hour.errors.accel_noise *= 0.05;
  return hour;
}

/// Told to be ten times as good: nearer to what it is.
Hour PerfectAndFine() {
  Hour hour = Perfect();
  hour.noise.angle_random_walk *= 0.1;
  hour.errors.gyro_bias_sigma *= 0.1;
  hour.errors.accel_bias_sigma *= 0.1;
  hour.errors.accel_noise *= 0.1;
  return hour;
}

/// Of a run of a tool without errors, the worst azimuth [deg].
double WorstOfPerfect(Hour hour, double inclination, double hz) {
  hour.inclination_deg = inclination;
  hour.imu_hz = hz;
  const Job job = ExternalJob(hour, 0, 1e-3);
  const Flown flown = Fly(hour, job, 0);
  const SmoothedRun run = EstimateOf(flown);
  const double azimuth = ToDegrees(WorstAzimuth(flown, run));
  const double level = ToDegrees(WorstInclination(flown, run));
  std::printf("%3.0f Hz, I %3.0f: worst azimuth %.1e deg, inclination %.1e\n", hz, inclination,
              azimuth, level);
  EXPECT_LT(level, 1e-4) << hz << " Hz, I " << inclination;
  return azimuth;
}

constexpr double kInclinations[] = {3., 10., 30., 60., 90., 110.};

// Inclination and toolface from the accelerometers of a tool that starts, rolls and travels.
TEST(Hours, OfAPerfectToolAreTheTruth) {
  for (const double hz : {100., 10.}) {
    for (const double inclination : kInclinations) {
      const bool often = hz < 100 && (inclination < 30 || inclination == 90);
      if (!often && !WELLGYRO_LONG) continue;
      const double worst = WorstOfPerfect(PerfectAndFine(), inclination, hz);
      EXPECT_LT(worst, inclination < 10 ? 2.7e-4 : 1.2e-4) << hz << " Hz, I " << inclination;
      EXPECT_GT(worst, 0);
    }
  }
}

// A job that states the noise of a tactical tool has the roll smoothed as that noise asks, which
// takes some of how the azimuth turns.
TEST(Hours, OfAPerfectToolTakenForATacticalOne) {
  for (const double inclination : kInclinations) {
    const double worst = WorstOfPerfect(Perfect(), inclination, 10);
    // A tenth of the sigma that this tool's noise makes at 3 deg, a fiftieth above.
    const double limit = inclination < 10 ? 1.3e-2 : inclination < 30 ? 1.6e-3 : 6e-4;
    EXPECT_LT(worst, limit) << "I " << inclination;
    EXPECT_GT(worst, 0);
  }
}

struct TacticalCase {
  double inclination_deg, rpm;
  double worst_deg;  // what a prototype of the same equations reached, rms of the worst error
};

void PrintTo(const TacticalCase& c, std::ostream* out) {
  *out << c.rpm << " rpm at " << c.inclination_deg << " deg";
}

class TacticalHours : public ::testing::TestWithParam<TacticalCase> {};

TEST_P(TacticalHours, EndAsSureAsTheySay) {
  const TacticalCase& c = GetParam();
  const std::uint64_t seeds = Seeds(6, 400);
  Claims known, estimated, inclination;
  double worst_estimated = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Hour hour = testing::Tactical();
    hour.inclination_deg = c.inclination_deg;
    hour.rpm = c.rpm;
    const Job job = ExternalJob(hour, seed, 1e-3);
    const Flown flown = Fly(hour, job, seed);
    const std::size_t last = flown.truth.size() - 1;
    const auto add = [&](const SmoothedRun& run, Claims* claims) {
      claims->Add(AzimuthError(flown, run, last), run.attitude[last].cov_attitude(1, 1));
    };
    add(testing::KnownOnTheWay(flown.history), &known);
    const SmoothedRun run = EstimateOf(flown);
    add(run, &estimated);
    worst_estimated +=
        std::pow(ToDegrees(WorstAzimuth(flown, run)), 2) / static_cast<double>(seeds);
    const std::size_t middle = last / 2;
    inclination.Add(run.attitude[middle].inclination - flown.truth[middle].inclination,
                    run.attitude[middle].cov_attitude(0, 0));
  }
  const std::string name = "I " + std::to_string(static_cast<int>(c.inclination_deg)) + ", " +
                           std::to_string(static_cast<int>(c.rpm)) + " rpm, ";
  known.ExpectTrue(name + "on the way");
  estimated.ExpectTrue(name + "estimated");
  inclination.ExpectTrue(name + "inclination");
  std::printf("%srms of the worst %.4f estimated, prototype %.4f deg\n", name.c_str(),
              std::sqrt(worst_estimated), c.worst_deg);
  // An rms of n draws is itself uncertain by 1/sqrt(2 n).
  const double few = WELLGYRO_LONG ? 1 : 1 + 3 / std::sqrt(2.0 * static_cast<double>(seeds));
  EXPECT_LT(std::sqrt(worst_estimated), 1.25 * few * c.worst_deg);
  if (WELLGYRO_LONG) {
    EXPECT_NEAR(known.rms_deg() / known.sigma_deg(), 1, 0.1);
    EXPECT_NEAR(estimated.rms_deg() / estimated.sigma_deg(), 1, 0.1);
  }
}

INSTANTIATE_TEST_SUITE_P(Inclinations, TacticalHours,
                         ::testing::Values(TacticalCase{3, 3, 0.283}, TacticalCase{10, 3, 0.080},
                                           TacticalCase{30, 3, 0.030}, TacticalCase{60, 3, 0.0176},
                                           TacticalCase{90, 3, 0.0144},
                                           TacticalCase{110, 3, 0.0154}, TacticalCase{3, 0, 1.20},
                                           TacticalCase{10, 0, 0.42}, TacticalCase{30, 0, 0.16},
                                           TacticalCase{60, 0, 0.095}, TacticalCase{90, 0, 0.084},
                                           TacticalCase{110, 0, 0.090}));

// Between 0.2 and 3.8 deg from vertical. The errors of an hour's knots are nearly one: one knot
// counts of those below a degree, and one of the others.
TEST(Hours, LeanAsSureAsTheySayNearVertical) {
  Claims nearest, above;
  for (std::uint64_t seed = 1; seed <= Seeds(3, 200); ++seed) {
    Hour hour = testing::Tactical();
    hour.inclination_deg = 2;
    hour.errors.accel_noise = 0.02 * units::kMilliG;
    const Flown flown = Fly(hour, ExternalJob(hour, seed, 1e-3), seed);
    const SmoothedRun run = EstimateOf(flown);
    for (const bool near : {true, false}) {
      std::vector<std::size_t> knots;
      for (std::size_t i = 0; i < flown.truth.size(); ++i) {
        if ((flown.truth[i].inclination < FromDegrees(1)) == near) knots.push_back(i);
      }
      ASSERT_GT(knots.size(), 100u) << seed;
      const std::size_t i = knots[knots.size() / 2];
      (near ? nearest : above)
          .Add(run.attitude[i].inclination - flown.truth[i].inclination,
               run.attitude[i].cov_attitude(0, 0));
    }
  }
  nearest.ExpectTrue("inclination nearest to vertical");
  above.ExpectTrue("inclination above");
}

// Strong drift, three stops, no azimuth from outside, one position at each stop.
struct UntoldCase {
  double swing_deg, rpm;
  double limit_deg;  // of the predicted sigma
};

void PrintTo(const UntoldCase& c, std::ostream* out) {
  *out << c.rpm << " rpm swinging " << c.swing_deg << " deg";
}

class UntoldHours : public ::testing::TestWithParam<UntoldCase> {};

TEST_P(UntoldHours, FindNorth) {
  const UntoldCase& c = GetParam();
  Claims end, inclination;
  for (std::uint64_t seed = 1; seed <= Seeds(1, 200); ++seed) {
    Hour hour = testing::StrongDrift();
    hour.swing_deg = c.swing_deg;
    hour.rpm = c.rpm;
    const Flown flown = Fly(hour, JobOf(hour), seed);
    const SmoothedRun run = EstimateOf(flown);
    ASSERT_TRUE(run.fit->converged) << seed;
    const AttitudeSample& last = run.attitude.back();
    ASSERT_TRUE(last.azimuth_known) << seed;
    end.Add(AzimuthError(flown, run, flown.truth.size() - 1), last.cov_attitude(1, 1));
    inclination.Add(last.inclination - flown.truth.back().inclination, last.cov_attitude(0, 0));
  }
  const std::string name = "no azimuth told, swing " +
                           std::to_string(static_cast<int>(c.swing_deg)) + ", " +
                           std::to_string(static_cast<int>(c.rpm)) + " rpm";
  end.ExpectTrue(name);
  inclination.ExpectTrue(name + ", inclination");
  EXPECT_LT(end.sigma_deg(), c.limit_deg);
}

INSTANTIATE_TEST_SUITE_P(Runs, UntoldHours,
                         ::testing::Values(UntoldCase{50, 3, 0.22}, UntoldCase{50, 0, 0.33},
                                           UntoldCase{2, 3, 1.5}, UntoldCase{2, 0, 3}));

// Errors as large as the industry's error models take them for a coarse tool.
TEST(Hours, OfACoarseToolEndAsSureAsTheySay) {
  for (const double rpm : {0., 0.3}) {
    for (const double inclination : {30., 60., 90.}) {
      Claims known, estimated;
      for (std::uint64_t seed = 1; seed <= Seeds(6, 400); ++seed) {
        Hour hour = testing::Tactical();
        hour.noise.angle_random_walk = 0.25 * units::kDegPerSqrtHour;
        hour.errors.gyro_bias_sigma = 0.5 * units::kDegPerHour;
        hour.inclination_deg = inclination;
        hour.rpm = rpm;
        const Flown flown = Fly(hour, ExternalJob(hour, seed, 0.1), seed);
        const std::size_t last = flown.truth.size() - 1;
        const SmoothedRun a = testing::KnownOnTheWay(flown.history), b = EstimateOf(flown);
        known.Add(AzimuthError(flown, a, last), a.attitude[last].cov_attitude(1, 1));
        estimated.Add(AzimuthError(flown, b, last), b.attitude[last].cov_attitude(1, 1));
      }
      const std::string name = "coarse, I " + std::to_string(static_cast<int>(inclination)) +
                               (rpm > 0 ? ", 0.3 rpm, " : ", sliding, ");
      known.ExpectTrue(name + "on the way");
      estimated.ExpectTrue(name + "estimated");
      if (WELLGYRO_LONG) {
        EXPECT_NEAR(known.rms_deg() / known.sigma_deg(), 1, 0.1);
        EXPECT_NEAR(estimated.rms_deg() / estimated.sigma_deg(), 1, 0.1);
      }
    }
  }
}

// From 12 to 80 deg of inclination while the tool turns one and a half times; both ends known.
Hour Build(int stops) {
  Hour hour = testing::StrongDrift();
  hour.inclination_deg = 12;
  hour.build_deg = 68;
  hour.rpm = 0.025;
  hour.roll_amplitude_deg = 0;
  hour.stops = stops;
  return hour;
}

// The run with its end told, exactly.
Flown Closed(Flown flown) {
  RunHistory& history = flown.history;
  history.ties.push_back(
      {history.knots.size(), flown.truth.back().azimuth, FromDegrees(1e-3), false});
  return flown;
}

TEST(Hours, ClosedBetweenTwoNorthsAreFarBetterThanWithTheDriftSpreadEvenly) {
  double spread = 0, closed = 0;
  Claims claims;
  const std::uint64_t seeds = Seeds(2, 100);
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Hour hour = Build(3);
    Job job = ExternalJob(hour, seed, 1e-3);
    const Flown stopped = Fly(hour, job, seed);
    const SmoothedRun estimated = EstimateOf(Closed(stopped));
    ASSERT_TRUE(estimated.fit->converged) << seed;
    job.alignment.use_fixes = false;
    const Flown reckoned = Fly(hour, job, seed);
    const SmoothedRun run = testing::KnownOnTheWay(reckoned.history);
    const std::size_t n = run.attitude.size();
    const double closure = AzimuthError(reckoned, run, n - 1);
    double sum_spread = 0, sum_closed = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(n - 1);
      sum_spread += std::pow(AzimuthError(reckoned, run, i) - share * closure, 2);
      sum_closed += std::pow(AzimuthError(stopped, estimated, i), 2);
    }
    spread += sum_spread / static_cast<double>(n * seeds);
    closed += sum_closed / static_cast<double>(n * seeds);
    const std::size_t middle = n / 2;
    claims.Add(AzimuthError(stopped, estimated, middle),
               estimated.attitude[middle].cov_attitude(1, 1));
  }
  std::printf("between two norths: rms %.4f deg with stops, %.4f with linear drift\n",
              ToDegrees(std::sqrt(closed)), ToDegrees(std::sqrt(spread)));
  claims.ExpectTrue("between two norths, half-way");
  EXPECT_LT(ToDegrees(std::sqrt(closed)), WELLGYRO_LONG ? 0.015 : 0.02);
  EXPECT_GT(std::sqrt(spread), 5 * std::sqrt(closed));
}

}  // namespace
}  // namespace wellgyro
