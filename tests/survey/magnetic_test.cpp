// Magnetometers: compared with the gyros at rest, mixed with them only where the job says so.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "support/hour.h"

namespace wellgyro {
namespace {

constexpr double kDeclination = FromDegrees(4);

/// Twenty minutes with two stops, in a field of 50 microtesla that dips by 72 deg.
struct MagneticFlight {
  explicit MagneticFlight(double inclination_deg, double undulation_deg = 1.8) {
    hour = testing::Tactical();
    hour.inclination_deg = inclination_deg;
    hour.azimuth_deg = 45;
    hour.undulation_deg = undulation_deg;
    hour.swing_deg = 0;
    hour.minutes = 20;
    hour.stops = 2;
    hour.errors.gyro_bias_sigma = 0.3 * units::kDegPerHour;
    simulation = testing::SimulationOf(hour, 5);
    const double level = 5e-5 * std::cos(FromDegrees(72));
    simulation.earth.field_L = {level * std::cos(kDeclination), level * std::sin(kDeclination),
                                5e-5 * std::sin(FromDegrees(72))};
    simulation.tool.has_mag = true;
    simulation.tool.errors.mag_noise = 50e-9;
    job = testing::JobOf(hour);
  }
  Survey Surveyed() const {
    testing::CollectingSink sink;
    return testing::SurveyOf(simulation, job, sink);
  }

  testing::Hour hour;
  Simulation simulation;
  Job job;
};

int Count(const Survey& survey, const std::string& code, Verdict verdict) {
  int count = 0;
  for (const Check& check : survey.checks) count += check.code == code && check.verdict == verdict;
  return count;
}

TEST(Magnetic, IsComparedAtEveryStop) {
  MagneticFlight flight(50);
  const Survey without = flight.Surveyed();
  EXPECT_EQ(Count(without, "magnetic_azimuth", Verdict::kNotDone), 1) << "no declination";
  for (const NorthFix& fix : without.runs.at(0).fixes) {
    ASSERT_TRUE(fix.magnetic_azimuth.has_value());
    const WellPoint truth = Truth(flight.simulation).well().PointAt(*fix.md);
    EXPECT_NEAR(ToDegrees(*fix.magnetic_azimuth), ToDegrees(truth.azimuth - kDeclination), 0.1);
  }
  flight.job.magnetic = MagneticSpec{.declination = kDeclination, .sigma = FromDegrees(0.3)};
  const Survey with = flight.Surveyed();
  EXPECT_EQ(Count(with, "magnetic_azimuth", Verdict::kFail), 0);
  EXPECT_EQ(Count(with, "magnetic_azimuth", Verdict::kPass) +
                Count(with, "magnetic_azimuth", Verdict::kWarn),
            2);
  ASSERT_EQ(with.chosen.size(), without.chosen.size());
  for (std::size_t i = 0; i < with.chosen.size(); ++i) {
    EXPECT_EQ(with.chosen[i].azimuth, without.chosen[i].azimuth) << "only compared";
  }
  flight.job.magnetic->declination = -kDeclination - FromDegrees(6);
  EXPECT_EQ(Count(flight.Surveyed(), "magnetic_azimuth", Verdict::kFail), 2);
  flight.simulation.tool.has_mag = false;
  EXPECT_EQ(Count(flight.Surveyed(), "magnetic_azimuth", Verdict::kNotDone), 1);
}

// At 90 deg, in a straight hole, the gyros do not tell 45 from 135 deg: two stops at other
// inclinations or azimuths do.
TEST(Magnetic, TiesOnceWhereTheJobSaysSo) {
  MagneticFlight flight(90, 0);
  flight.job.magnetic = MagneticSpec{.declination = kDeclination, .sigma = FromDegrees(3)};
  EXPECT_LT(flight.Surveyed().chosen.size(), 2u) << "no north";
  flight.job.magnetic->tie = true;
  const Survey tied = flight.Surveyed();
  ASSERT_GT(tied.chosen.size(), 20u);
  int ties = 0;
  for (const NorthFix& fix : tied.runs.at(0).fixes) ties += fix.external;
  EXPECT_EQ(ties, 1);
  const Truth truth(flight.simulation);
  for (const Station& s : tied.chosen) {
    const double error = WrapPi(s.azimuth - truth.well().PointAt(s.md).azimuth);
    const double sigma = std::sqrt(s.cov_md_inc_azi(2, 2));
    EXPECT_LT(std::abs(error), 4 * sigma) << s.md;
    EXPECT_LT(sigma, FromDegrees(3)) << "the gyros know it better";
    EXPECT_FALSE(Has(s.quality, Quality::kMirror));
  }
}

TEST(Magnetic, ASigmaThatCannotBeIsRefused) {
  Job job;
  job.magnetic = MagneticSpec{.declination = 0.1};
  EXPECT_THROW(CheckJob(job), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro
