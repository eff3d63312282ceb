#include "wellgyro/uncertainty/propagate.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/base/units.h"

#include "cases.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::HasSubstr;

using units::kDeg;
using Vector3L = Eigen::Matrix<long double, 3, 1>;

ErrorModel OneTerm(const std::string& code, double magnitude, Propagation propagation) {
  ErrorModel model;
  model.name = code;
  model.terms.push_back({code, FindWeight(code), magnitude, propagation});
  model.max_inclination = kPi;
  model.vertical_limit = 1e-4 * kDeg;
  model.doubled_tie_on = false;
  return model;
}

/// A hole that builds, turns and drops, at uneven stations, never vertical.
std::vector<SurveyPoint> Crooked() {
  std::vector<SurveyPoint> survey;
  double md = 0;
  for (int k = 0; k < 60; ++k) {
    survey.push_back({md, (35 + 25 * std::sin(0.07 * k)) * kDeg, 0.3 + 0.05 * k, 0});
    md += 20 + 7 * (k % 3);
  }
  test::AddDepths(survey);
  return survey;
}

Surroundings Somewhere() {
  Surroundings place;
  place.latitude = 50 * kDeg;
  return place;
}

/// Balanced tangential positions, in long double: half of each leg along each end's direction.
std::vector<Vector3L> Positions(const std::vector<SurveyPoint>& survey, std::size_t moved,
                                const std::vector<Vector3L>& shift, bool all) {
  std::vector<Vector3L> direction, position = {Vector3L::Zero()};
  std::vector<long double> md;
  for (std::size_t k = 0; k < survey.size(); ++k) {
    const bool shifted = k > 0 && (all || k == moved);
    const Vector3L d = shifted ? shift[k] : Vector3L::Zero();
    const long double i = survey[k].inclination + d.y(), a = survey[k].azimuth + d.z();
    direction.push_back({std::sin(i) * std::cos(a), std::sin(i) * std::sin(a), std::cos(i)});
    md.push_back(survey[k].md + d.x());
    if (k > 0)
      position.push_back(position.back() +
                         (md[k] - md[k - 1]) / 2 * (direction[k - 1] + direction[k]));
  }
  return position;
}

/// Covariance by moving the stations themselves: all together or each alone, both ways.
std::vector<Matrix3d> ByMoving(const std::vector<SurveyPoint>& survey,
                               const std::vector<Vector3L>& unit, double sigma, bool random) {
  constexpr long double kStep = 1e-6L;
  std::vector<Matrix3d> cov(survey.size(), Matrix3d::Zero());
  std::vector<Vector3L> up, down;
  for (const Vector3L& u : unit) up.push_back(kStep * u), down.push_back(-kStep * u);
  for (std::size_t moved = 1; moved < (random ? survey.size() : 2); ++moved) {
    const auto a = Positions(survey, moved, up, !random);
    const auto b = Positions(survey, moved, down, !random);
    for (std::size_t k = 0; k < survey.size(); ++k) {
      const Vector3d e = ((a[k] - b[k]) / (2 * kStep) * sigma).cast<double>();
      cov[k] += e * e.transpose();
    }
  }
  return cov;
}

struct Law {
  const char* code;
  double magnitude;
  Vector3L (*unit)(const SurveyPoint&);
};

const Law kLaws[] = {
    {"DREF", 0.5, [](const SurveyPoint&) { return Vector3L(1, 0, 0); }},
    {"DSF", 1e-3, [](const SurveyPoint& p) { return Vector3L(p.md, 0, 0); }},
    {"AXYZ-MIS", 1e-3, [](const SurveyPoint&) { return Vector3L(0, 1, 0); }},
    {"AXYZ-SF", 1e-3,
     [](const SurveyPoint& p) {
       return Vector3L(0, 1.3 * std::sin(p.inclination) * std::cos(p.inclination), 0);
     }},
    {"AZ", 2e-3, [](const SurveyPoint&) { return Vector3L(0, 0, 1); }},
    {"XYM3", 2e-3,
     [](const SurveyPoint& p) {
       const double c = std::abs(std::cos(p.inclination));
       return Vector3L(0, c * std::cos(p.azimuth),
                       -c * std::sin(p.azimuth) / std::sin(p.inclination));
     }},
};

// A term's covariance is what moving the stations by its weight does to balanced tangential
// positions: together for a systematic error, one by one for a random one.
TEST(PropagateErrors, IsWhatMovedStationsDo) {
  const auto survey = Crooked();
  for (const Law& law : kLaws) {
    std::vector<Vector3L> unit;
    for (const SurveyPoint& p : survey) unit.push_back(law.unit(p));
    for (const bool random : {false, true}) {
      const auto mode = random ? Propagation::kRandom : Propagation::kSystematic;
      const auto result =
          PropagateErrors(survey, Somewhere(), OneTerm(law.code, law.magnitude, mode));
      const auto moved = ByMoving(survey, unit, law.magnitude, random);
      for (std::size_t k = 1; k < survey.size(); ++k)
        EXPECT_LT((result.cov_p_W[k] - moved[k]).norm(), 1e-8 * moved[k].norm()) << law.code << k;
    }
  }
}

// Rev 5: the first leg's direction is wholly the first station's.
TEST(PropagateErrors, DoubledTieOnDoublesTheFirstLeg) {
  const auto survey = Crooked();
  ErrorModel model = OneTerm("AZ", 1e-3, Propagation::kSystematic);
  const double single = std::sqrt(PropagateErrors(survey, Somewhere(), model).cov_p_W[1].trace());
  model.doubled_tie_on = true;
  const auto doubled = PropagateErrors(survey, Somewhere(), model);
  EXPECT_NEAR(std::sqrt(doubled.cov_p_W[1].trace()), 2 * single, 1e-12 * single);
  const double leg = survey[1].md * std::sin(survey[1].inclination) * 1e-3;
  EXPECT_NEAR(std::sqrt(doubled.cov_p_W[1].trace()), leg, 1e-12 * leg);
}

// Grid azimuths with a convergence: the same well, told in the grid's frame.
TEST(PropagateErrors, ConvergenceOnlyTurnsTheFrame) {
  const double convergence = 3 * kDeg;
  auto grid = test::StandardWell(3, "spe90408-appendix-e.txt").survey;
  auto true_north = grid;
  for (SurveyPoint& p : true_north)
    if (p.inclination > 0) p.azimuth += convergence;
  Surroundings place = Somewhere(), turned = place;
  turned.convergence = convergence;
  Matrix3d r = Matrix3d::Identity();
  r << std::cos(convergence), -std::sin(convergence), 0, std::sin(convergence),
      std::cos(convergence), 0, 0, 0, 1;
  for (const char* name : {"spe90408-3", "spe90408-6", "GYRO-NS-CT"}) {
    ErrorModel model = test::Model(name);
    // What an accelerometer error does to a vertical hole depends on the azimuth it is listed with,
    // which is 0 in either frame: without the terms that act there.
    std::erase_if(model.terms, [](const ErrorTerm& t) {
      return t.name.starts_with("AXY") || t.name.starts_with("XCL");
    });
    const auto a = PropagateErrors(grid, turned, model);
    const auto b = PropagateErrors(true_north, place, model);
    ASSERT_EQ(a.cov_p_W.size(), grid.size());
    const Matrix3d turned_back = r * a.cov_p_W.back() * r.transpose();
    EXPECT_LT((turned_back - b.cov_p_W.back()).norm(), 1e-9 * b.cov_p_W.back().norm()) << name;
  }
}

// Two legs of one model: systematic errors hold within a run, well-by-well ones throughout.
TEST(PropagateErrors, LegsCorrelateByPropagation) {
  const auto survey = Crooked();
  const std::size_t half = survey.size() / 2;
  const auto end = [&](Propagation propagation, int second_run) {
    const ErrorModel model = OneTerm("AZ", 1e-3, propagation);
    const ToolLeg legs[] = {{&model, 0, half, 1}, {&model, half, survey.size(), second_run}};
    return PropagateErrors(survey, Somewhere(), legs).cov_p_W.back();
  };
  const auto whole = [&](Propagation propagation) {
    return PropagateErrors(survey, Somewhere(), OneTerm("AZ", 1e-3, propagation)).cov_p_W.back();
  };
  const Matrix3d joined = whole(Propagation::kSystematic);
  EXPECT_LT((end(Propagation::kSystematic, 1) - joined).norm(), 1e-12 * joined.norm());
  EXPECT_LT((end(Propagation::kWell, 2) - joined).norm(), 1e-12 * joined.norm());
  EXPECT_LT((end(Propagation::kGlobal, 2) - joined).norm(), 1e-12 * joined.norm());
  const Matrix3d random = whole(Propagation::kRandom);
  EXPECT_LT((end(Propagation::kRandom, 2) - random).norm(), 1e-12 * random.norm());

  // Apart: each half's part alone, as an error that only its stations have.
  std::vector<Vector3L> first(survey.size(), Vector3L::Zero()), second = first;
  for (std::size_t k = 0; k < survey.size(); ++k) (k < half ? first : second)[k].z() = 1;
  const Matrix3d apart =
      ByMoving(survey, first, 1e-3, false).back() + ByMoving(survey, second, 1e-3, false).back();
  const Matrix3d two_runs = end(Propagation::kSystematic, 2);
  EXPECT_LT((two_runs - apart).norm(), 1e-8 * apart.norm());
  EXPECT_GT((two_runs - joined).norm(), 0.1 * joined.norm());
}

// The model of one leg says nothing about the other's stations.
TEST(PropagateErrors, LegsOfDifferentModelsAddUp) {
  const auto survey = Crooked();
  const std::size_t half = survey.size() / 2;
  const ErrorModel a = OneTerm("AZ", 1e-3, Propagation::kSystematic);
  const ErrorModel b = OneTerm("AXYZ-MIS", 2e-3, Propagation::kSystematic);
  const ToolLeg legs[] = {{&a, 0, half, 1}, {&b, half, survey.size(), 2}};
  PropagateOptions options;
  options.terms = true;
  options.cov_tie_in_W = Vector3d(4, 1, 9).asDiagonal();
  const auto result = PropagateErrors(survey, Somewhere(), legs, options);
  std::vector<Vector3L> first(survey.size(), Vector3L::Zero()), second = first;
  for (std::size_t k = 0; k < survey.size(); ++k) (k < half ? first[k].z() : second[k].y()) = 1;
  const auto part_a = ByMoving(survey, first, 1e-3, false);
  const auto part_b = ByMoving(survey, second, 2e-3, false);
  ASSERT_EQ(result.terms.size(), 2u);
  for (std::size_t k = 1; k < survey.size(); ++k) {
    EXPECT_LT((result.terms[0].cov_p_W[k] - part_a[k]).norm(), 1e-8 * part_a[k].norm()) << k;
    EXPECT_LT((result.terms[1].cov_p_W[k] - part_b[k]).norm(), 1e-8 * part_b[k].norm() + 1e-20)
        << k;
    const Matrix3d sum =
        options.cov_tie_in_W + result.terms[0].cov_p_W[k] + result.terms[1].cov_p_W[k];
    EXPECT_LT((result.cov_p_W[k] - sum).norm(), 1e-12 * sum.norm());
  }
}

// Terms are the whole: no source is left out of the total, none counted twice.
TEST(PropagateErrors, TermsSumToTheTotal) {
  for (const char* name : {"spe90408-4", "GYRO-NS-CT", "CB_Film_GMS", "ISCWSA-MWD-Rev4"}) {
    const auto well = test::StandardWell(1, "iscwsa-mwd-rev5.1.txt");
    PropagateOptions options;
    options.terms = true;
    const ErrorModel model = test::Model(name);
    const auto result = PropagateErrors(well.survey, well.place, model, options);
    EXPECT_EQ(result.terms.size(), model.terms.size());
    for (std::size_t k = 0; k < result.cov_p_W.size(); ++k) {
      Matrix3d sum = Matrix3d::Zero();
      for (const auto& term : result.terms) sum += term.cov_p_W[k];
      EXPECT_LT((sum - result.cov_p_W[k]).norm(), 1e-12 * sum.norm()) << name << k;
    }
    for (const auto& term : result.terms)
      EXPECT_GT(term.cov_p_W.back().norm(), 0) << name << " " << term.term;  // none silently zero
  }
}

TEST(PropagateErrors, RefusesATwoAxisGyrocompassAboveItsEnd) {
  const auto survey = test::MadeSurvey(3000, 30, [](SurveyPoint& p) {
    p.inclination = std::min(95.0, 0.05 * p.md) * kDeg;
    p.azimuth = 1;
  });
  const auto ns = PropagateErrors(survey, Somewhere(), test::Model("GYRO-NS"));
  ASSERT_TRUE(ns.refusal);
  EXPECT_NEAR(survey[ns.refusal->station].inclination, 90 * kDeg, 1e-9);
  EXPECT_EQ(ns.cov_p_W.size(), ns.refusal->station);
  EXPECT_THAT(ns.refusal->text, HasSubstr("89 deg"));
  EXPECT_FALSE(PropagateErrors(survey, Somewhere(), test::Model("GYRO-NS-CT")).refusal);

  ErrorModel low = test::Model("GYRO-NS");
  low.stationary->end = 40 * kDeg;
  const auto ended = PropagateErrors(survey, Somewhere(), low);
  ASSERT_TRUE(ended.refusal);
  EXPECT_NEAR(survey[ended.refusal->station].inclination, 40.5 * kDeg, 1 * kDeg);
}

// Up to the last station that is served, no weight has grown beyond what 89 deg makes of it.
TEST(PropagateErrors, NothingAbsurdBeforeARefusal) {
  for (const char* name : {"GYRO-NS", "GYRO-MWD", "CB_Film_GMS", "spe90408-1", "spe90408-2"}) {
    for (double azimuth = 0; azimuth < 6.2; azimuth += 0.7) {
      const auto survey = test::MadeSurvey(3000, 10, [&](SurveyPoint& p) {
        p.inclination = 0.05 * p.md * kDeg;
        p.azimuth = azimuth;
      });
      const auto result = PropagateErrors(survey, Somewhere(), test::Model(name));
      ASSERT_TRUE(result.refusal) << name;
      EXPECT_LE(survey[result.refusal->station - 1].inclination, 89.5 * kDeg);
      EXPECT_LT(result.cov_p_W.back().trace(), 4e5) << name;
    }
  }
}

TEST(PropagateErrors, NamesTheCallersMistakes) {
  const auto survey = Crooked();
  const ErrorModel ct = test::Model("GYRO-NS-CT");
  const auto message = [](auto call) -> std::string {
    try {
      call();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  const auto run = [&](const std::vector<SurveyPoint>& s, const Surroundings& p,
                       const ErrorModel& m) { return message([&] { PropagateErrors(s, p, m); }); };
  EXPECT_THAT(run({survey[0]}, Somewhere(), ct), HasSubstr("two stations"));
  EXPECT_THAT(run(survey, Surroundings{}, ct), HasSubstr("latitude is needed"));
  Surroundings pole;
  pole.latitude = 89.5 * kDeg;
  EXPECT_THAT(run(survey, pole, ct), HasSubstr("89 deg"));
  EXPECT_THAT(run(survey, Somewhere(), test::Model("ISCWSA-MWD-Rev5.1")), HasSubstr("dip"));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (double SurveyPoint::*member :
         {&SurveyPoint::md, &SurveyPoint::inclination, &SurveyPoint::azimuth, &SurveyPoint::tvd}) {
      auto wrong = survey;
      wrong[7].*member = bad;
      EXPECT_THAT(run(wrong, Somewhere(), ct), HasSubstr("station 8"));
    }
    Surroundings place = Somewhere();
    place.gravity = bad;
    EXPECT_THAT(run(survey, place, ct), HasSubstr("gravity"));
  }
  auto back = survey;
  back[5].md = back[4].md;
  EXPECT_THAT(run(back, Somewhere(), ct), HasSubstr("does not increase"));
  ErrorModel incomplete = ct;
  incomplete.tortuosity.reset();
  EXPECT_THAT(run(survey, Somewhere(), incomplete), HasSubstr("term XCLA"));
  const ToolLeg gap[] = {{&ct, 0, 10, 1}, {&ct, 11, survey.size(), 1}};
  EXPECT_THAT(message([&] { PropagateErrors(survey, Somewhere(), gap); }), HasSubstr("station 11"));
}

}  // namespace
}  // namespace wellgyro
