#include "wellgyro/uncertainty/station_errors.h"

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/model_catalogue.h"
#include "wellgyro/math/rotation.h"

#include "cases.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

using units::kDeg;

/// From a vertical root up to 60 deg, turning, at uneven stations.
std::vector<SurveyPoint> Building() {
  std::vector<SurveyPoint> survey;
  double md = 0;
  for (int k = 0; k < 60; ++k) {
    survey.push_back(
        {md, k < 5 ? 0 : (60 - 60 * std::exp(-0.06 * (k - 4))) * kDeg, 0.3 + 0.02 * k, 0});
    md += 20 + 7 * (k % 3);
  }
  test::AddDepths(survey);
  return survey;
}

Surroundings MagneticPlace() {
  Surroundings place;
  place.latitude = 50 * kDeg;
  place.field = 5e-5;
  place.dip = 70 * kDeg;
  place.declination = 0;
  return place;
}

/// Positions summed from the errors themselves: directions by halves of the courses at either side,
/// depths along the legs that they lengthen.
std::vector<Matrix3d> Summed(const std::vector<SurveyPoint>& survey, const SurveyErrors& errors) {
  std::vector<Vector3d> t;
  for (const SurveyPoint& p : survey) t.push_back(Tangent(p.inclination, p.azimuth));
  std::map<std::pair<std::size_t, std::int64_t>, std::vector<StationError>> factors;
  for (const StationError& e : errors.errors) factors[{e.source, e.group}].push_back(e);
  std::vector<Matrix3d> cov(survey.size(), Matrix3d::Zero());
  for (const auto& [key, of_factor] : factors) {
    std::vector<Vector3d> direction(survey.size(), Vector3d::Zero()), moved = direction;
    std::vector<double> md(survey.size(), 0);
    for (const StationError& e : of_factor) {
      direction[e.station] += e.direction_W;
      moved[e.station] += e.displacement_W;
      md[e.station] += e.md;
    }
    Vector3d sum = Vector3d::Zero();
    cov[0] += md[0] * t[0] * (md[0] * t[0]).transpose();
    for (std::size_t k = 1; k < survey.size(); ++k) {
      const double course = survey[k].md - survey[k - 1].md;
      const bool doubled = k == 1 && errors.doubled_tie_on;
      const double gained = md[k] - (k == 1 ? 0 : md[k - 1]);
      sum += course / 2 * ((doubled ? direction[1] : direction[k - 1]) + direction[k]) +
             gained / 2 * (t[k - 1] + t[k]) + moved[k];
      cov[k] += sum * sum.transpose();
    }
  }
  return cov;
}

// Two sums of the same errors: rounding only.
TEST(ErrorsAtStations, AddUpToTheCovarianceOfPropagateErrors) {
  const std::vector<SurveyPoint> survey = Building();
  int models = 0;
  for (const ErrorModel& model : OwnModels()) {
    const PositionUncertainty expected = PropagateErrors(survey, MagneticPlace(), model);
    const ToolLeg leg{&model, 0, survey.size(), 1};
    const SurveyErrors errors = ErrorsAtStations(survey, MagneticPlace(), {&leg, 1});
    EXPECT_EQ(errors.stations, expected.cov_p_W.size()) << model.name;
    if (expected.refusal) continue;
    ++models;
    const std::vector<Matrix3d> cov = Summed(survey, errors);
    for (std::size_t k = 0; k < survey.size(); ++k) {
      EXPECT_LE((cov[k] - expected.cov_p_W[k]).norm(), 1e-9 * expected.cov_p_W[k].norm() + 1e-15)
          << model.name << " station " << k;
    }
    EXPECT_GT(expected.cov_p_W.back().trace(), 1);
  }
  EXPECT_GE(models, 6);
}

TEST(ErrorsAtStations, LegsOfOneRunShareWhatIsSystematic) {
  const std::vector<SurveyPoint> survey = Building();
  const ErrorModel model = *OwnModel("ISCWSA MWD Rev 4");
  for (const int second_run : {1, 2}) {
    const ToolLeg legs[] = {{&model, 0, 30, 1}, {&model, 30, survey.size(), second_run}};
    const PositionUncertainty expected = PropagateErrors(survey, MagneticPlace(), legs);
    const SurveyErrors errors = ErrorsAtStations(survey, MagneticPlace(), legs);
    const Matrix3d cov = Summed(survey, errors).back();
    EXPECT_LE((cov - expected.cov_p_W.back()).norm(), 1e-9 * cov.norm());
  }
}

// Below the datum a first station is a measurement as any other; at MD 0 a convention.
TEST(ErrorsAtStations, AFirstStationBelowTheDatumIsMeasured) {
  std::vector<SurveyPoint> survey = Building();
  survey.erase(survey.begin(), survey.begin() + 20);
  const ErrorModel model = *OwnModel("ISCWSA MWD Rev 4");
  const ToolLeg leg{&model, 0, survey.size(), 1};
  const SurveyErrors errors = ErrorsAtStations(survey, MagneticPlace(), {&leg, 1});
  EXPECT_TRUE(errors.first_is_measured);
  double of_first = 0, of_second = 0;
  for (const StationError& e : errors.errors) {
    if (e.station == 0) of_first += e.direction_W.squaredNorm();
    if (e.station == 1) of_second += e.direction_W.squaredNorm();
  }
  EXPECT_GT(of_first, 0.8 * of_second);
  EXPECT_LT(of_first, 1.2 * of_second);
}

}  // namespace
}  // namespace wellgyro
