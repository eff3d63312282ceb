#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/uncertainty/allan_error.h"

#include "allan_profiles.h"

// Exact Allan covariances against the drawn processes themselves, integrated step by step along
// finely split paths. The drawing shares nothing with the library but its random numbers.
namespace wellgyro {
namespace {

using test::AllanProfiles;
using test::Profile;

using units::kDeg;
constexpr int kSubsteps = 6;
constexpr int kRuns = WELLGYRO_MONTE_CARLO_RUNS;

enum Part { kN, kBiasConstant, kBiasMarkov, kK, kR, kParts };
constexpr const char* kNoiseNames[] = {"ALLAN-N", "ALLAN-B", "ALLAN-B", "ALLAN-K", "ALLAN-R"};
constexpr double kN_ = 0.25 * units::kDegPerSqrtHour;
constexpr double kB = 0.5 * units::kDegPerHour;
constexpr double kTc = 0.5 * units::kHour;
constexpr double kKwalk = 0.5 * units::kDegPerHourSqrtHour;
constexpr double kRamp = 0.3 * units::kDegPerHour2;
constexpr double kGate = 15 * kDeg;
constexpr double kSpeed = 0.6;

/// One step of the path: what it makes of a rate and of an azimuth error.
struct Step {
  double seconds = 0;
  bool open = false;
  double gain = 0;             ///< in its middle
  double north = 0, east = 0;  ///< of a unit azimuth error, in its middle [m]
};

std::vector<Step> StepsOf(const std::vector<SurveyPoint>& fine) {
  std::vector<Step> steps;
  for (std::size_t k = 1; k < fine.size(); ++k) {
    const double inclination = (fine[k - 1].inclination + fine[k].inclination) / 2;
    const double turn = std::remainder(fine[k].azimuth - fine[k - 1].azimuth, 2 * kPi);
    const double azimuth = fine[k - 1].azimuth + turn / 2, length = fine[k].md - fine[k - 1].md;
    Step step;
    step.seconds = length / kSpeed;
    step.open = inclination > kGate;
    step.gain = 1 / std::sin(std::max(inclination, 0.01));
    step.north = -length * std::sin(inclination) * std::sin(azimuth);
    step.east = length * std::sin(inclination) * std::cos(azimuth);
    steps.push_back(step);
  }
  return steps;
}

using Drawn = std::array<std::array<double, 3>, kParts>;  ///< azimuth, north, east

/// One tool on its way: explicit recursions of the five processes.
Drawn Draw(const std::vector<Step>& steps, Random& random) {
  Drawn x{};
  const double sigma = 1.076 * kB;
  const double constant = kB * random.Normal(), slope = kRamp * random.Normal();
  double markov = sigma * random.Normal(), walk = 0, elapsed = 0;
  bool open = false;
  for (const Step& s : steps) {
    const double decay = std::exp(-s.seconds / kTc);
    const double markov_next =
        decay * markov + sigma * std::sqrt(1 - decay * decay) * random.Normal();
    if (s.open) {
      if (!open) walk = elapsed = 0;
      const double walk_next = walk + kKwalk * std::sqrt(s.seconds) * random.Normal();
      const double dt = s.seconds;
      const std::array<double, kParts> turn = {
          kN_ * std::sqrt(dt) * random.Normal(), constant * dt, (markov + markov_next) / 2 * dt,
          (walk + walk_next) / 2 * dt, slope * (elapsed + dt / 2) * dt};
      for (std::size_t i = 0; i < kParts; ++i) {
        const double before = x[i][0], after = before + s.gain * turn[i];
        x[i] = {after, x[i][1] + s.north * (before + after) / 2,
                x[i][2] + s.east * (before + after) / 2};
      }
      walk = walk_next;
      elapsed += dt;
    }
    open = s.open;
    markov = markov_next;
  }
  return x;
}

AllanUncertainty Exact(const Profile& profile, bool markov) {
  AllanRun run;
  run.speed = kSpeed;
  run.initialise = kGate;
  run.noise.angle_random_walk = kN_;
  run.noise.bias_instability = kB;
  if (markov) run.noise.bias_instability_correlation_time = kTc;
  run.noise.rate_random_walk = kKwalk;
  run.noise.rate_ramp = kRamp;
  return AllanErrors(profile.survey, run);
}

class AllanMonteCarlo : public testing::TestWithParam<int> {};

// 1 sigma of a standard deviation from n runs is 1/sqrt(2n): 0.35 % of 40 000, 1.1 % of 4000.
TEST_P(AllanMonteCarlo, SigmasOfAzimuthAndPositionAgree) {
  const Profile profile = AllanProfiles()[static_cast<std::size_t>(GetParam())];
  const std::vector<Step> steps = StepsOf(test::Split(profile.survey, kSubsteps));
  std::array<std::array<double, 2>, kParts> sums{};
  Random random(20260 + static_cast<unsigned>(GetParam()));
  for (int i = 0; i < kRuns; ++i) {
    const Drawn x = Draw(steps, random);
    for (std::size_t p = 0; p < kParts; ++p) {
      sums[p][0] += x[p][0] * x[p][0];
      sums[p][1] += x[p][1] * x[p][1] + x[p][2] * x[p][2];
    }
  }
  double worst = 0;
  const double tolerance = kRuns >= 40000 ? 0.01 : 3.5 / std::sqrt(2.0 * kRuns);
  for (std::size_t p = 0; p < kParts; ++p) {
    const AllanUncertainty exact = Exact(profile, p == kBiasMarkov);
    ASSERT_FALSE(exact.refusal);
    const auto term = std::ranges::find(exact.terms, kNoiseNames[p], &AllanTerm::term);
    ASSERT_NE(term, exact.terms.end()) << kNoiseNames[p];
    const double azimuth = std::sqrt(term->var_azimuth.back() / (sums[p][0] / kRuns)) - 1;
    const double position = std::sqrt(term->cov_p_W.back().trace() / (sums[p][1] / kRuns)) - 1;
    EXPECT_NEAR(azimuth, 0, tolerance) << profile.name << " " << p;
    EXPECT_NEAR(position, 0, tolerance) << profile.name << " " << p;
    worst = std::max({worst, std::abs(azimuth), std::abs(position)});
  }
  std::printf("%s: worst %.2f %% of a sigma\n", profile.name.c_str(), 100 * worst);
}

INSTANTIATE_TEST_SUITE_P(Profiles, AllanMonteCarlo, testing::Range(0, 4));

}  // namespace
}  // namespace wellgyro
