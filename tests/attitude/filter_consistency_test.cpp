#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/attitude/along_hole_covariance.h"
#include "wellgyro/attitude/filter.h"
#include "wellgyro/attitude/smoother.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/math/statistics.h"

#include "attitude/filter_truth.h"

// Normalised errors squared over drawn tools, inside their chi-square bands: the covariances are
// neither hopeful nor timid. Each band leaves out 1e-4 at either end.
namespace wellgyro {
namespace {

using filter_truth::FixOf;
using filter_truth::MakeKnots;
using filter_truth::Plan;
using filter_truth::Pose;
using filter_truth::SetupAt;
using filter_truth::Truth;

class Bands {
 public:
  void Add(const std::string& what, double squared, int dof) {
    auto& [sum, total] = sums_[what];
    sum += squared;
    total += dof;
  }
  void Check() const {
    for (const auto& [what, s] : sums_) {
      const auto& [sum, dof] = s;
      EXPECT_GT(sum, ChiSquareQuantile(1e-4, dof)) << what << ": mean " << sum / dof;
      EXPECT_LT(sum, ChiSquareQuantile(1 - 1e-4, dof)) << what << ": mean " << sum / dof;
    }
  }

 private:
  std::map<std::string, std::pair<double, double>> sums_;
};

// A tactical tool with every error that the knots of the test carry.
FilterSetup TacticalTool() {
  FilterSetup s = SetupAt(FromDegrees(60));
  s.gyro.angle_random_walk = 0.01 * units::kDegPerSqrtHour;
  s.gyro.bias_instability = 0.05 * units::kDegPerHour;
  s.gyro.bias_instability_correlation_time = 600;
  s.gyro.rate_random_walk = 0.05 * units::kDegPerHourSqrtHour;
  s.gyro.rate_ramp = 0.05 * units::kDegPerHour2;
  s.errors.gyro_bias_sigma = 0.1 * units::kDegPerHour;
  s.errors.mass_unbalance_sigma = 0.05 * units::kDegPerHourPerG;
  s.errors.quadrature_sigma = 0.05 * units::kDegPerHourPerG;
  s.errors.gyro_scale_sigma = 3e-4;
  s.errors.accel_bias_sigma = 0.2 * units::kMilliG;
  s.errors.latitude_sigma = FromDegrees(0.05);
  return s;
}

struct Case {
  const char* name;
  double inclination;  // [deg]
  double rpm;
  bool out;            // time against depth
  double azimuth;      // [deg]
  bool filter = true;  // whether the filter's own values are asked for
};

constexpr double kStop1 = 600, kStop2 = 2100, kStopLength = 300, kEnd = 3000;

// How far along its way the tool is: it stands still twice.
double Way(double t) {
  const double s1 = std::clamp(t - kStop1, 0.0, kStopLength);
  const double s2 = std::clamp(t - kStop2, 0.0, kStopLength);
  return t - s1 - s2;
}

bool Still(double t) {
  return (t > kStop1 && t < kStop1 + kStopLength) || (t > kStop2 && t < kStop2 + kStopLength);
}

Plan PlanOf(const Case& c) {
  Plan plan;
  plan.motion = [c](double t) {
    const double s = Way(t);
    return Pose{.inclination = FromDegrees(c.inclination + 3 * std::sin(s / 250)),
                .azimuth = FromDegrees(c.azimuth + 50 * std::sin(s / 700)),
                .toolface = 0.4 + c.rpm * kTwoPi / 60 * s + 0.4 * std::sin(s / 90),
                .md = c.out ? 4000 - 0.5 * s : 500 + 0.5 * s};
  };
  plan.seconds = kEnd;
  plan.knot_seconds = 10;
  plan.steps_per_knot = 8;
  plan.still = Still;
  return plan;
}

Eigen::Vector3d LegSum(const std::vector<Eigen::Vector3d>& t, const std::vector<double>& md,
                       std::size_t to) {
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i <= to; ++i) r += (md[i] - md[i - 1]) / 2 * (t[i - 1] + t[i]);
  return r;
}

// Position errors of stations by their own angles, the first (in depth) being right.
void AddPositions(const std::string& what, std::vector<StationState> stations, const Truth& truth,
                  bool out, Bands* bands) {
  if (out) std::reverse(stations.begin(), stations.end());
  const auto cov =
      CovarianceAlongHole(stations, out ? TimeAlongHole::kAgainstDepth : TimeAlongHole::kWithDepth,
                          Eigen::Matrix3d::Zero(), 0);
  std::vector<Eigen::Vector3d> error;
  std::vector<double> md;
  for (const StationState& s : stations) {
    const Pose& p = truth.poses[s.epoch];
    // To first order, as a covariance is meant: an azimuth wrong by one degree shortens a hole
    // by 1.5e-4 of its length, which the other errors do not reach.
    const double i = s.attitude.inclination, a = s.attitude.azimuth;
    error.push_back(Tangent(i + kPi / 2, a) * (i - p.inclination) +
                    Tangent(kPi / 2, a + kPi / 2) * std::sin(i) * WrapPi(a - p.azimuth));
    md.push_back(p.md);
  }
  for (const std::size_t k : {error.size() / 3, error.size() - 1}) {
    const Eigen::Vector3d d = LegSum(error, md, k);
    bands->Add(what + " position " + std::to_string(3 * k / (error.size() - 1)),
               d.dot(cov[k].ldlt().solve(d)), 3);
  }
}

void AddAzimuth(const std::string& what, const AttitudeSample& a, const Pose& truth, Bands* bands) {
  const double d = WrapPi(a.azimuth - truth.azimuth);
  bands->Add(what, d * d / a.cov_attitude(1, 1), 1);
  const Eigen::Vector2d both(a.inclination - truth.inclination, d);
  const Eigen::Matrix2d cov = a.cov_attitude.topLeftCorner<2, 2>();
  bands->Add(what + " with inclination", both.dot(cov.ldlt().solve(both)), 2);
}

void AddRun(const Case& c, std::uint64_t seed, bool start_known, bool fixes, Bands* bands) {
  FilterSetup setup = TacticalTool();
  const Plan plan = PlanOf(c);
  const Truth truth = MakeKnots(plan, setup, seed);
  if (start_known) {
    setup.start_sigma = FromDegrees(0.2);
    setup.start_azimuth = truth.start.azimuth + setup.start_sigma * Random(seed + 9999).Normal();
  }
  AzimuthFilter filter(setup);
  const std::string name = c.name;
  for (std::size_t i = 0; i < truth.knots.size(); ++i) {
    filter.Step(truth.knots[i]);
    const double t = (truth.knots[i].time - ToolTime{}).seconds();
    if (!Still(t - 5) && i % 5 == 4) filter.MarkStation();
    for (const double stop : {kStop1, kStop2}) {
      // The fix comes late, as it does when the tool has to move before its stop is known to end.
      if (!fixes || std::abs(t - stop - kStopLength - 20) > 1) continue;
      const auto begin = static_cast<std::size_t>(stop / 10), end = begin + 30;
      const FilterFix f =
          filter.Update(FixOf(truth.knots, begin, end, setup, truth.poses[begin].azimuth));
      ASSERT_TRUE(f.rates);
      if (!c.filter) continue;
      AddAzimuth(name + " filter after stop " + (stop == kStop1 ? "1" : "2"), filter.attitude(),
                 truth.poses[i], bands);
    }
    if (t == kStop2 && (start_known || c.filter)) {
      AddAzimuth(name + " filter before stop 2", filter.attitude(), truth.poses[i], bands);
    }
  }
  if (start_known || c.filter)
    AddAzimuth(name + " filter end", filter.attitude(), truth.poses.back(), bands);
  if (start_known) AddPositions(name + " filter", filter.stations(), truth, c.out, bands);

  const SmoothedRun run = Smooth(filter.history());
  for (const std::size_t i : {0u, 30u, 120u, 180u, 299u}) {
    AddAzimuth(name + " smoothed " + std::to_string(i), run.attitude[i], truth.poses[i], bands);
  }
  AddPositions(name + " smoothed", run.stations, truth, c.out, bands);
}

// In the last one a single fix is uncertain by 4 deg at 78 deg azimuth and the rates are far from
// linear in it: more than a filter can do that never looks back.
constexpr Case kCases[] = {{"steep sliding", 12, 0, false, 40},
                           {"inclined rolling out", 50, 2, true, 40},
                           {"flat sliding out", 85, 0, true, -10},
                           {"inclined sliding", 35, 0, false, 130},
                           {"flat east out", 85, 0, true, 40, false}};

constexpr std::uint64_t kSeeds = 100;

TEST(FilterConsistency, DeadReckoningFromAKnownStart) {
  Bands bands;
  std::uint64_t number = 0;
  for (const Case& c : kCases) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) AddRun(c, ++number, true, false, &bands);
  }
  bands.Check();
}

TEST(FilterConsistency, StopsOnTheWayFromAnUnknownStart) {
  Bands bands;
  std::uint64_t number = 0;
  for (const Case& c : kCases) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      AddRun(c, ++number, false, true, &bands);
    }
  }
  bands.Check();
}

}  // namespace
}  // namespace wellgyro
