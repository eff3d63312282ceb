// Whether what is claimed of azimuth, inclination and position at the end of a survey is true:
// dead reckoned, as told on the way, and adjusted.
#include <cmath>
#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "support/claims.h"
#include "support/hour.h"

namespace wellgyro {
namespace {

using testing::Claims;
using testing::Hour;

// Two hundred seeds of each case, or one of each of a few and these judged together.
constexpr std::uint64_t kTruthSeeds = WELLGYRO_LONG ? 200 : 1;
// Of nine numbers of each of these sets all are to hold with 99 %.
constexpr double kRisk = 0.01 / (9 * (WELLGYRO_LONG ? 9 : 1));

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

void PrintTo(const TruthCase& c, std::ostream* out) {
  *out << c.rpm << " rpm at " << c.inclination_deg << " deg";
}

// Few seeds are each case's own, so that all cases together are as many independent runs.
void AddRuns(const TruthCase& c, WaysOfSurvey& one) {
  const Hour hour = WornTool(c.inclination_deg, c.rpm);
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
}

std::string NameOf(const TruthCase& c) {
  return "I " + std::to_string(static_cast<int>(c.inclination_deg)) + ", " +
         std::to_string(static_cast<int>(c.rpm)) + " rpm, ";
}

class CovarianceTruth : public ::testing::TestWithParam<std::vector<TruthCase>> {};

TEST_P(CovarianceTruth, OfAzimuthInclinationAndPosition) {
  WaysOfSurvey all;
  for (const TruthCase& c : GetParam()) AddRuns(c, all);
  const std::string name = GetParam().size() == 1 ? NameOf(GetParam()[0]) : "all cases, ";
  all.reckoned.ExpectTrue(name + "reckoned");
  all.filtered.ExpectTrue(name + "filtered");
  all.adjusted.ExpectTrue(name + "adjusted");
}

std::vector<std::vector<TruthCase>> TruthCases() {
  const std::vector<TruthCase> all{{5, 3},  {30, 3}, {60, 3}, {90, 3}, {5, 0},
                                   {30, 0}, {60, 0}, {90, 0}, {60, 20}};
  if (!WELLGYRO_LONG) return {{{5, 3}, {60, 0}, {60, 20}}};
  std::vector<std::vector<TruthCase>> each;
  for (const TruthCase& c : all) each.push_back({c});
  return each;
}

INSTANTIATE_TEST_SUITE_P(Runs, CovarianceTruth, ::testing::ValuesIn(TruthCases()));

}  // namespace
}  // namespace wellgyro
