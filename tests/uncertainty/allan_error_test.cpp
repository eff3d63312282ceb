#include "wellgyro/uncertainty/allan_error.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/uncertainty/gyro_mode.h"

#include "allan_profiles.h"
#include "cases.h"

namespace wellgyro {
namespace {

using test::AllanProfiles;
using test::MadeSurvey;
using test::Profile;
using test::Split;

constexpr double kHour = units::kHour;
using units::kDeg;

AllanRun Everything() {
  AllanRun run;
  run.speed = 0.6;
  run.initialise = 15 * kDeg;
  run.noise.quantization = 3 * units::kArcsec;
  run.noise.angle_random_walk = 0.25 * units::kDegPerSqrtHour;
  run.noise.bias_instability = 0.5 * units::kDegPerHour;
  run.noise.bias_instability_correlation_time = 0.5 * kHour;
  run.noise.rate_random_walk = 0.5 * units::kDegPerHourSqrtHour;
  run.noise.rate_ramp = 0.3 * units::kDegPerHour2;
  return run;
}

const AllanTerm& Term(const AllanUncertainty& result, const std::string& name) {
  for (const AllanTerm& term : result.terms)
    if (term.term == name) return term;
  ADD_FAILURE() << "no term " << name;
  return result.terms.front();
}

// A straight hole at 30 deg (a = 2) along east: the textbook integrals, t the time since the fix.
//   A: N^2 a^2 t, B^2 a^2 t^2, K^2 a^2 t^3/3, R^2 a^2 t^4/4
//   north position (v sin I) x: N^2 a^2 t^3/3, B^2 a^2 t^4/4, K^2 a^2 t^5/20, R^2 a^2 t^6/36
TEST(AllanErrors, StraightHoleHasTheTextbookIntegrals) {
  AllanRun run = Everything();
  run.noise.quantization = 0;
  run.noise.bias_instability_correlation_time.reset();
  const auto survey = MadeSurvey(1500, 1500, [](SurveyPoint& p) {
    p.inclination = 30 * kDeg;
    p.azimuth = 90 * kDeg;
  });
  const AllanUncertainty result = AllanErrors(survey, run);
  ASSERT_FALSE(result.refusal);
  const double t = 1500 / 0.6, a2 = 4, lever2 = std::pow(0.6 * 0.5, 2);
  const auto check = [&](const char* name, double var_azimuth, double var_north) {
    const AllanTerm& term = Term(result, name);
    EXPECT_NEAR(term.var_azimuth[1] / var_azimuth, 1, 1e-9) << name;
    EXPECT_NEAR(term.cov_p_W[1](0, 0) / var_north, 1, 1e-9) << name;
    EXPECT_NEAR(term.cov_p_W[1](1, 1), 0, 1e-9 * var_north) << name;
  };
  const NoiseCoefficients& n = run.noise;
  const auto squared = [](double x) { return x * x; };
  const double N = squared(n.angle_random_walk), B = squared(n.bias_instability),
               K = squared(n.rate_random_walk), R = squared(n.rate_ramp);
  check("ALLAN-N", N * a2 * t, lever2 * N * a2 * std::pow(t, 3) / 3);
  check("ALLAN-B", B * a2 * t * t, lever2 * B * a2 * std::pow(t, 4) / 4);
  check("ALLAN-K", K * a2 * std::pow(t, 3) / 3, lever2 * K * a2 * std::pow(t, 5) / 20);
  check("ALLAN-R", R * a2 * std::pow(t, 4) / 4, lever2 * R * a2 * std::pow(t, 6) / 36);
}

// Stations may be added on the same path at will: no sigma moves by more than 0.1 %.
TEST(AllanErrors, SplittingEveryLegThirtyTimesChangesNothing) {
  std::vector<Profile> profiles = AllanProfiles();
  profiles.push_back({"ISCWSA 1", test::StandardWell(1, "iscwsa-mwd-rev5.1.txt").survey});
  profiles.push_back({"ISCWSA 3", test::StandardWell(3, "iscwsa-mwd-rev5.1.txt").survey});
  const AllanRun run = Everything();
  for (const Profile& profile : profiles) {
    const auto coarse = AllanErrors(profile.survey, run);
    const auto fine = AllanErrors(Split(profile.survey, 30), run);
    double worst = 0;
    for (std::size_t i = 0; i < coarse.terms.size(); ++i) {
      for (std::size_t k = 1; k < profile.survey.size(); ++k) {
        const auto compare = [&](double c, double f) {
          if (f < 1e-20) {
            EXPECT_LT(c, 1e-18);
            return;
          }
          worst = std::max(worst, std::abs(std::sqrt(c / f) - 1));
        };
        compare(coarse.terms[i].var_azimuth[k], fine.terms[i].var_azimuth[30 * k]);
        const Eigen::Matrix3d& c = coarse.terms[i].cov_p_W[k];
        const Eigen::Matrix3d& f = fine.terms[i].cov_p_W[30 * k];
        compare(c.trace(), f.trace());
      }
    }
    EXPECT_LT(worst, 1e-3) << profile.name;
    RecordProperty("worst " + profile.name, std::to_string(worst));
  }
}

// The rules at fixes, on a well that builds, drops below the gate and builds again.
TEST(AllanErrors, AFixMakesTheAzimuthNewAndKeepsThePosition) {
  const auto survey = MadeSurvey(3000, 30, [](SurveyPoint& p) {
    p.inclination = 40 * kDeg * std::pow(std::sin(std::numbers::pi * p.md / 1500), 2);
    p.azimuth = 1;
  });
  AllanRun run = Everything();
  run.sigma_azimuth = 0.1 * kDeg;
  const AllanUncertainty result = AllanErrors(survey, run);
  ASSERT_FALSE(result.refusal);
  const std::size_t rest = 50, first = 25, second = 75;  // vertical at MD 1500
  EXPECT_EQ(result.var_azimuth[rest], 0);
  EXPECT_GT(result.cov_p_W[rest].trace(), 0);
  for (std::size_t k = rest - 5; k < rest + 5; ++k)
    EXPECT_EQ(result.cov_p_W[k], result.cov_p_W[rest]);  // at rest nothing moves
  for (const char* name : {"ALLAN-N", "ALLAN-K", "ALLAN-R", "ALLAN-B", "FIX"}) {
    const AllanTerm& term = Term(result, name);
    EXPECT_NEAR(term.var_azimuth[second] / term.var_azimuth[first], 1, 1e-6) << name;
  }
  // One fix is independent of the other, one constant slope is not of itself.
  const auto gain = [&](const char* name) {
    const AllanTerm& term = Term(result, name);
    return term.cov_p_W[100].trace() / term.cov_p_W[rest].trace();
  };
  EXPECT_NEAR(gain("FIX"), 2, 1e-6);
  EXPECT_NEAR(gain("ALLAN-N"), 2, 1e-6);
  EXPECT_NEAR(gain("ALLAN-K"), 2, 1e-6);
  EXPECT_NEAR(gain("ALLAN-R"), 4, 1e-6);
  EXPECT_GT(gain("ALLAN-B"), 2.05);  // half an hour of memory, some of it left
  EXPECT_LT(gain("ALLAN-B"), 3.9);
}

TEST(AllanErrors, RefusesWhereTheGyroFeelsNoTurn) {
  const auto survey =
      MadeSurvey(900, 30, [](SurveyPoint& p) { p.inclination = p.md * 0.1 * kDeg; });
  AllanRun run = Everything();
  run.initialise = -1;
  auto result = AllanErrors(survey, run);  // two axes in a vertical hole
  ASSERT_TRUE(result.refusal);
  EXPECT_EQ(result.refusal->station, 0u);
  run.axes = GyroAxes::kZ;  // one axis, up to the horizontal
  result = AllanErrors(survey, run);
  ASSERT_TRUE(result.refusal);
  EXPECT_EQ(result.cov_p_W.size(), result.refusal->station);
  EXPECT_GE(result.refusal->station, 29u);
  run.axes = GyroAxes::kXyz;
  EXPECT_FALSE(AllanErrors(survey, run).refusal);
}

// The printed form is the recursion of SPE 90408 tables 6 to 8: at the first stations after the
// gate it agrees in azimuth with N and B where the path is straight.
TEST(PrintedAllan, SaysWhatItLeavesOut) {
  const PrintedAllan printed = PrintedAllanModel(Everything());
  EXPECT_EQ(printed.left_out, std::vector<std::string>{"ALLAN-Q"});
  EXPECT_FALSE(FindComplaint(printed.model));
  AllanRun external = Everything();
  external.initialise = -1;
  EXPECT_FALSE(FindComplaint(PrintedAllanModel(external).model));
}

// The four recursions by hand over three legs of a straight hole at 30 deg: a = 2, 40 s, 60 s, 20
// s.
TEST(PrintedAllan, FourRecursionsByHand) {
  std::vector<SurveyPoint> survey;
  for (const double md : {0.0, 40.0, 100.0, 120.0}) survey.push_back({md, 30 * kDeg, 90 * kDeg, 0});
  const double a = 2, legs[] = {40, 60, 20};
  double n = 0, b = 0, k = 0, r = 0;
  for (const double dt : legs) {
    n += a * a * dt;
    b += a * dt;
    k += a * a * dt * dt * dt / 3;
    r += a * dt * dt / 2;
  }
  const double expected[] = {std::sqrt(n), b, std::sqrt(k), r};
  const char* const codes[] = {"GXY-GRW", "GXY-GD", "GXY-GRR", "GXY-GR"};
  for (int i = 0; i < 4; ++i) {
    AllanRun run;
    run.speed = 1;
    run.initialise = -1;
    double* const coefficients[] = {&run.noise.angle_random_walk, &run.noise.bias_instability,
                                    &run.noise.rate_random_walk, &run.noise.rate_ramp};
    *coefficients[i] = 1e-5;
    ErrorModel model = PrintedAllanModel(run).model;
    std::erase_if(model.terms, [](const ErrorTerm& t) { return t.magnitude == 0; });
    ASSERT_EQ(model.terms.size(), 1U);
    EXPECT_EQ(model.terms[0].weight->code, codes[i]);
    GyroModeTracker tracker(model);
    tracker.Begin(survey[0]);
    for (std::size_t s = 1; s < survey.size(); ++s) tracker.Advance(survey[s - 1], survey[s]);
    const GyroMode& mode = tracker.mode();
    const double h[] = {std::sqrt(mode.walk_time[0]), mode.drift_time[0],
                        std::sqrt(mode.rate_walk_time[0]), mode.ramp_time[0]};
    EXPECT_NEAR(h[i], expected[i], 1e-9 * expected[i]) << codes[i];
    // And as they reach the position: the last station's own error moves it over half a leg.
    const auto errors = PropagateErrors(survey, {}, model);
    EXPECT_GT(errors.cov_p_W.back().trace(), 0) << codes[i];
  }
}

// Section 5 (iv) of the gyro literature's recursion: on a straight hole the printed form overstates
// N in position by sqrt(4/3), since it takes the walk as one error along the hole.
TEST(PrintedAllan, OverstatesTheWalkOnAStraightHole) {
  AllanRun run = Everything();
  run.initialise = -1;
  run.noise = {};
  run.noise.angle_random_walk = 0.25 * units::kDegPerSqrtHour;
  const auto survey = MadeSurvey(3000, 3, [](SurveyPoint& p) { p.inclination = 50 * kDeg; });
  const auto exact = AllanErrors(survey, run);
  Surroundings place;
  const auto printed = PropagateErrors(survey, place, PrintedAllanModel(run).model);
  const double ratio = std::sqrt(printed.cov_p_W.back()(1, 1) / exact.cov_p_W.back()(1, 1));
  EXPECT_NEAR(ratio, std::sqrt(4.0 / 3), 2e-3);
}

}  // namespace
}  // namespace wellgyro
