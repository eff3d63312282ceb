// Two axes near horizontal see an azimuth and its mirror nearly alike. What a stop cannot tell, the
// run as a whole can.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "support/claims.h"
#include "support/hour.h"

namespace wellgyro {
namespace {

struct Case {
  double inclination_deg, swing_deg, rpm;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.inclination_deg << " deg, swing " << c.swing_deg << ", " << c.rpm << " rpm";
}

/// Half an hour with three stops at azimuth 45, gyro bias 0.3 deg/h, that undulates by 1.8 deg.
testing::Hour HourOf(const Case& c) {
  testing::Hour hour = testing::Tactical();
  hour.errors.gyro_bias_sigma = 0.3 * units::kDegPerHour;
  hour.inclination_deg = c.inclination_deg;
  hour.azimuth_deg = 45;
  hour.swing_deg = c.swing_deg;
  hour.rpm = c.rpm;
  hour.minutes = 30;
  hour.stops = 3;
  return hour;
}

struct Count {
  int ambiguous = 0;         ///< stops
  int none = 0, silent = 0;  ///< runs without stations, wrong ones that say nothing of it
  int flagged = 0;           ///< stations that still have a mirror
};

Count Fly(const Case& c, int seeds, const RunAdjuster* adjuster) {
  Count count;
  for (int seed = 1; seed <= seeds; ++seed) {
    const testing::Hour hour = HourOf(c);
    const Simulation simulation = testing::SimulationOf(hour, static_cast<std::uint64_t>(seed));
    Job job = testing::JobOf(hour);
    job.stations.at_stops = true;
    testing::CollectingSink sink;
    const Survey survey = testing::SurveyOf(simulation, job, sink, {}, adjuster);
    for (const NorthFix& fix : survey.runs.at(0).fixes) {
      count.ambiguous += Has(fix.quality, Quality::kMirror);
    }
    const Truth truth(simulation);
    bool silent = false;
    for (const Station& s : survey.chosen) {
      const double error = WrapPi(s.azimuth - truth.well().PointAt(s.md).azimuth);
      const double sigma = std::sqrt(s.cov_md_inc_azi(2, 2));
      const bool flagged = Has(s.quality, Quality::kMirror);
      count.flagged += flagged;
      silent = silent || (!flagged && std::abs(error) > std::max(5 * sigma, FromDegrees(3)));
    }
    count.silent += silent;
    count.none += survey.chosen.size() < 3;
  }
  return count;
}

class Mirror : public ::testing::TestWithParam<Case> {};

TEST_P(Mirror, IsNeverTakenSilently) {
  constexpr int kSeeds = WELLGYRO_LONG ? 8 : 1;
  const testing::KeepingAdjuster keeper;
  const Count reckoned = Fly(GetParam(), kSeeds, &keeper);
  EXPECT_EQ(reckoned.silent, 0);
  EXPECT_GT(2 * reckoned.ambiguous, kSeeds) << "of the three stops of each run";
  const Count estimated = Fly(GetParam(), kSeeds, nullptr);
  EXPECT_EQ(estimated.silent, 0);
  EXPECT_LE(estimated.none, kSeeds / 8) << "of " << reckoned.none << " on the way";
  EXPECT_EQ(estimated.flagged, 0);
}

INSTANTIATE_TEST_SUITE_P(Runs, Mirror,
                         ::testing::Values(Case{88, 0, 0}, Case{88, 30, 3}, Case{89, 0, 3},
                                           Case{90, 0, 0}, Case{90, 30, 3}));

// Straight holes so near to east-west and to horizontal that azimuth and mirror run into one, of a
// tool most errors of which have a prior.
struct Straight {
  double inclination_deg, azimuth_deg, bias_degph, rpm;
  int stops;
};

constexpr Straight kFew[] = {
    {88, 80, 0.1, 3, 3}, {90, 75, 0.3, 3, 1}, {90, 95, 0.1, 3, 3}, {89, 265, 0.1, 3, 3}};
constexpr Straight kMany[] = {{88, 80, 0.1, 3, 3},  {90, 75, 0.3, 3, 1}, {90, 95, 0.1, 3, 3},
                              {89, 265, 0.1, 3, 3}, {85, 85, 0.1, 3, 3}, {88, 95, 0.1, 3, 1},
                              {88, 80, 0.1, 0, 3},  {90, 75, 0.1, 0, 3}, {89, 85, 0.1, 0, 1},
                              {88, 75, 0.1, 3, 3},  {89, 95, 0.1, 3, 3}, {90, 85, 0.1, 3, 3},
                              {86, 88, 0.1, 3, 3}};

testing::Hour HourOf(const Straight& c) {
  testing::Hour hour;
  hour.noise.angle_random_walk = 0.005 * units::kDegPerSqrtHour;
  hour.noise.bias_instability = 0.02 * units::kDegPerHour;
  hour.noise.bias_instability_correlation_time = 0.3 * 3600;
  hour.noise.rate_random_walk = 0.01 * units::kDegPerHourSqrtHour;
  hour.errors.gyro_bias_sigma = c.bias_degph * units::kDegPerHour;
  hour.errors.mass_unbalance_sigma = 0.02 * units::kDegPerHourPerG;
  hour.errors.quadrature_sigma = 0.02 * units::kDegPerHourPerG;
  hour.errors.gyro_scale_sigma = 1e-4;
  hour.errors.gyro_misalignment_sigma = 1e-4;
  hour.errors.accel_bias_sigma = 5e-4;
  hour.errors.accel_noise = 2e-4;
  hour.errors.roll_offset_sigma = FromDegrees(0.02);
  hour.inclination_deg = c.inclination_deg;
  hour.undulation_deg = 0;
  hour.azimuth_deg = c.azimuth_deg;
  hour.swing_deg = 0;
  hour.rpm = c.rpm;
  if (c.rpm > 0) hour.roll_amplitude_deg = 0;
  hour.stops = c.stops;
  hour.speed = 1;
  hour.minutes = 1000. / 60 + c.stops * 3;
  hour.depth_resolution = 0;
  return hour;
}

struct End {
  bool known;
  double azimuth, variance;
};

End EndOf(const SmoothedRun& run, std::size_t last) {
  const AttitudeSample& a = run.attitude[last];
  return {a.azimuth_known, a.azimuth, a.cov_attitude(1, 1)};
}

TEST(MirrorNearEastWest, IsNotGivenAsSure) {
  const std::uint64_t seeds = WELLGYRO_LONG ? 40 : 1;
  const std::span<const Straight> cases =
      WELLGYRO_LONG ? std::span<const Straight>(kMany) : std::span<const Straight>(kFew);
  constexpr std::array<const char*, 2> kBy = {"on the way", "estimated"};
  std::array<testing::Claims, 2> claims;
  for (const Straight& c : cases) {
    const testing::Hour hour = HourOf(c);
    std::array<testing::Claims, 2> here;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const testing::Flown flight = testing::Fly(hour, testing::JobOf(hour), seed);
      const std::size_t last = flight.truth.size() - 1;
      const std::array<End, 2> ends = {EndOf(testing::KnownOnTheWay(flight.history), last),
                                       EndOf(EstimateOf(flight), last)};
      for (std::size_t k = 0; k < ends.size(); ++k) {
        if (!ends[k].known) continue;
        const double error = WrapPi(ends[k].azimuth - flight.truth[last].azimuth);
        here[k].Add(error, ends[k].variance);
        EXPECT_LT(std::abs(error), 4.5 * std::sqrt(ends[k].variance))
            << kBy[k] << ", I " << c.inclination_deg << ", A " << c.azimuth_deg << ", " << c.rpm
            << " rpm, seed " << seed << ": " << ToDegrees(error) << " of "
            << ToDegrees(std::sqrt(ends[k].variance));
      }
    }
    std::printf("I %g, A %g, %g rpm, %d stops, of %d give an azimuth:", c.inclination_deg,
                c.azimuth_deg, c.rpm, c.stops, static_cast<int>(seeds));
    for (std::size_t k = 0; k < here.size(); ++k) {
      const bool any = here[k].count > 0;
      std::printf(" %s %d, sigma %.2f deg, mean square %.2f;", kBy[k], here[k].count,
                  any ? here[k].sigma_deg() : 0, any ? here[k].mean() : 0);
      claims[k].Add(here[k]);
    }
    std::printf("\n");
  }
  for (std::size_t k = 0; k < claims.size(); ++k) {
    // On the way two azimuths that are as likely are none.
    const bool whole = k == 1;
    ASSERT_GT(3 * claims[k].count, whole ? static_cast<int>(seeds * cases.size()) : 0)
        << "refusing all would be easy";
    claims[k].ExpectTrue(std::string("near horizontal and east-west, ") + kBy[k]);
  }
}

}  // namespace
}  // namespace wellgyro
