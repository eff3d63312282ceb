// Two axes near horizontal see an azimuth and its mirror nearly alike. What a stop cannot tell, the
// run as a whole can.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "wellgyro/fit/run_adjustment.h"

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
  constexpr int kSeeds = 8;
  const Count reckoned = Fly(GetParam(), kSeeds, nullptr);
  EXPECT_EQ(reckoned.silent, 0);
  EXPECT_GT(reckoned.ambiguous, kSeeds) << "of the three stops of each run";
  const LeastSquaresAdjuster adjuster;
  const Count adjusted = Fly(GetParam(), kSeeds, &adjuster);
  EXPECT_EQ(adjusted.silent, 0);
  EXPECT_EQ(adjusted.none, 0) << "of " << reckoned.none << " without adjustment";
  EXPECT_EQ(adjusted.flagged, 0);
}

INSTANTIATE_TEST_SUITE_P(Runs, Mirror,
                         ::testing::Values(Case{88, 0, 0}, Case{88, 30, 3}, Case{89, 0, 3},
                                           Case{90, 0, 0}, Case{90, 30, 3}));

}  // namespace
}  // namespace wellgyro
