// Whether what is claimed of azimuth, inclination and position at the end of a survey is true:
// dead reckoned, as told on the way, and adjusted.
#include <cmath>
#include <cstdint>
#include <string>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "support/claims.h"
#include "support/hour.h"

namespace wellgyro {
namespace {

using testing::Claims;
using testing::Hour;

// Two hundred seeds where WELLGYRO_LONG.
constexpr std::uint64_t kTruthSeeds = WELLGYRO_LONG ? 200 : 1;
// Eighty-one tests, of which all are to hold with 99 %.
constexpr double kRisk = 0.01 / 81;

// Every error that a job can state, but for the scale of depth and the latitude.
Hour WornTool(double inclination_deg, double rpm) {
  Hour hour = testing::StrongDrift();
  hour.inclination_deg = inclination_deg;
  hour.rpm = rpm;
  hour.errors.gyro_scale_sigma = 1e-4;
  hour.errors.gyro_misalignment_sigma = 1e-4;
  hour.errors.roll_offset_sigma = FromDegrees(0.02);
  hour.errors.time_skew_sigma = 1e-3;
  hour.errors.accel_scale_sigma = 5e-5;
  hour.errors.accel_misalignment_sigma = 1e-4;
  return hour;
}

// Told the azimuth at the begin to 0.1 deg, and the place exactly.
Job TiedJob(const Hour& hour, const Simulation& simulation, std::uint64_t seed) {
  Job job = testing::ExternalJob(hour, seed, 0.1);
  const Eigen::Vector3d begin = Truth(simulation).well().PlaceAt(job.tie_in.md).p_WT_W;
  job.tie_in.north = begin.x();
  job.tie_in.east = begin.y();
  job.tie_in.tvd = begin.z();
  return job;
}

struct ThreeClaims {
  Claims azimuth, inclination, position;
  ThreeClaims() { position.dof = 3; }

  // The station is where the tool was, which its depth tells to `depth_offset`.
  void Add(const Station& s, const Truth& truth, double depth_offset) {
    const double md = s.md - depth_offset;
    const WellPoint point = truth.well().PointAt(md);
    azimuth.Add(WrapPi(s.azimuth - point.azimuth), s.cov_md_inc_azi(2, 2));
    inclination.Add(s.inclination - point.inclination, s.cov_md_inc_azi(1, 1));
    const Eigen::Vector3d off = s.p_WT_W - truth.well().PlaceAt(md).p_WT_W;
    const double square = off.dot(s.cov_p_WT_W.ldlt().solve(off));
    position.Add(square, off.squaredNorm(), s.cov_p_WT_W.trace());
  }
  void Add(const ThreeClaims& others) {
    azimuth.Add(others.azimuth);
    inclination.Add(others.inclination);
    position.Add(others.position);
  }
  void ExpectTrue(const std::string& what) const {
    azimuth.ExpectTrue(what + ", azimuth", kRisk);
    inclination.ExpectTrue(what + ", inclination", kRisk);
    position.ExpectTrue(what + ", position", kRisk);
  }
};

struct WaysOfSurvey {
  ThreeClaims reckoned, filtered, adjusted;
};

struct TruthCase {
  double inclination_deg, rpm;
};

class CovarianceTruth : public ::testing::TestWithParam<TruthCase> {
 protected:
  static void SetUpTestSuite() { all_ = {}; }
  // One run of a case says little, those of all cases together more.
  static void TearDownTestSuite() {
    if (WELLGYRO_LONG) return;
    all_.reckoned.ExpectTrue("all cases, reckoned");
    all_.filtered.ExpectTrue("all cases, filtered");
    all_.adjusted.ExpectTrue("all cases, adjusted");
  }
  inline static WaysOfSurvey all_;
};

TEST_P(CovarianceTruth, OfAzimuthInclinationAndPosition) {
  WaysOfSurvey one;
  const Hour hour = WornTool(GetParam().inclination_deg, GetParam().rpm);
  // Few seeds are each case's own, so that all cases together are as many independent runs.
  const std::uint64_t first =
      WELLGYRO_LONG ? 1 : static_cast<std::uint64_t>(10 * hour.inclination_deg + hour.rpm);
  for (std::uint64_t seed = first; seed < first + kTruthSeeds; ++seed) {
    const Simulation simulation = testing::SimulationOf(hour, seed);
    const Truth truth(simulation);
    const double offset = simulation.tool.errors.depth_offset;
    Job job = TiedJob(hour, simulation, seed);
    testing::CollectingSink sink;
    Surveyor surveyor(job, sink);
    testing::Play(simulation, surveyor);
    surveyor.Finish();
    one.adjusted.Add(surveyor.Current(0).chosen.back(), truth, offset);
    const Station* told = nullptr;
    for (const Station& s : sink.stations) {
      if (s.status != StationStatus::kProvisional || s.pass != Pass::kIn) continue;
      if (told == nullptr || s.md > told->md) told = &s;
    }
    ASSERT_NE(told, nullptr);
    one.filtered.Add(*told, truth, offset);

    job.alignment.use_fixes = false;
    testing::CollectingSink quiet;
    Surveyor alone(job, quiet);
    testing::Play(simulation, alone);
    alone.Finish();
    one.reckoned.Add(alone.Current(0).chosen.back(), truth, offset);
  }
  const std::string name = "I " + std::to_string(static_cast<int>(GetParam().inclination_deg)) +
                           ", " + std::to_string(static_cast<int>(GetParam().rpm)) + " rpm, ";
  one.reckoned.ExpectTrue(name + "reckoned");
  one.filtered.ExpectTrue(name + "filtered");
  one.adjusted.ExpectTrue(name + "adjusted");
  all_.reckoned.Add(one.reckoned);
  all_.filtered.Add(one.filtered);
  all_.adjusted.Add(one.adjusted);
}

INSTANTIATE_TEST_SUITE_P(Runs, CovarianceTruth,
                         ::testing::Values(TruthCase{5, 3}, TruthCase{30, 3}, TruthCase{60, 3},
                                           TruthCase{90, 3}, TruthCase{5, 0}, TruthCase{30, 0},
                                           TruthCase{60, 0}, TruthCase{90, 0}, TruthCase{60, 20}));

}  // namespace
}  // namespace wellgyro
