#include "wellgyro/survey/separation.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/survey/well_uncertainty.h"
#include "wellgyro/uncertainty/error_model.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;

ErrorModel OneTerm(Propagation propagation) {
  ErrorModel model;
  model.name = "one term";
  model.terms.push_back({"AZ", FindWeight("AZ"), 0.01, propagation});
  model.max_inclination = kPi;
  model.vertical_limit = 1e-6;
  return model;
}

/// Straight, from `start`, towards `azimuth`, 2000 m along in 100 m.
SurveyedWell Straight(const Vector3d& start, double inclination, double azimuth) {
  std::vector<SurveyPoint> stations;
  for (int k = 0; k <= 20; ++k) stations.push_back({100.0 * k, inclination, azimuth, 0});
  return SurveyWell(stations, start);
}

struct Known {
  SurveyedWell well;
  ErrorModel model;
  PositionUncertainty errors;

  Known(SurveyedWell surveyed, Propagation propagation)
      : well(std::move(surveyed)), model(OneTerm(propagation)) {
    const ToolLeg leg{&model, 0, well.survey.size(), 1};
    errors = PropagateErrors(well.survey, {}, std::span(&leg, 1));
  }
  UncertainWell view() const { return {&well, &errors}; }
};

// Two parallel wells, 50 m apart across: an azimuth error of 0.01 rad moves each across by 0.01 x.
// Each its own: sqrt(2) of it. The same global one: none of it.
TEST(Separations, SharedErrorsCancelBetweenParallelWells) {
  const double i = 1.2, x = 2000 * std::sin(i);
  const SurveyedWell a = Straight({0, 0, 0}, i, 0), b = Straight({0, 50, 0}, i, 0);
  const Known own_a(a, Propagation::kSystematic), own_b(b, Propagation::kSystematic);
  const Separation own = Separations(own_a.view(), own_b.view(), Pairing::kTwoWells).back();
  EXPECT_NEAR(own.distance, 50, 1e-9);
  EXPECT_NEAR(own.vector.y(), 50, 1e-9);
  EXPECT_NEAR(own.other_md, 2000, 1e-6);
  EXPECT_NEAR(own.sigma, std::sqrt(2) * 0.01 * x, 1e-9 * x);
  EXPECT_NEAR(*own.sigmas, 50 / own.sigma, 1e-12);

  const Known same_a(a, Propagation::kGlobal), same_b(b, Propagation::kGlobal);
  const Separation same = Separations(same_a.view(), same_b.view(), Pairing::kTwoWells).back();
  EXPECT_NEAR(same.sigma, 0, 1e-6);

  // Well-by-well errors are another well's own, but one hole's common.
  const Known well_a(a, Propagation::kWell), well_b(b, Propagation::kWell);
  EXPECT_NEAR(Separations(well_a.view(), well_b.view(), Pairing::kTwoWells).back().sigma, own.sigma,
              1e-9);
  EXPECT_NEAR(Separations(well_a.view(), well_b.view(), Pairing::kSameHole).back().sigma, 0, 1e-6);
}

// Antiparallel wells: the same azimuth error moves them apart, twice as far.
TEST(Separations, SharedErrorsAddBetweenOppositeWells) {
  const double i = kPi / 2, x = 2000;
  const Known a(Straight({0, 0, 0}, i, 0), Propagation::kGlobal);
  const Known b(Straight({4000, 30, 0}, i, kPi), Propagation::kGlobal);
  const Separation s = Separations(a.view(), b.view(), Pairing::kTwoWells).back();
  EXPECT_NEAR(s.distance, 30, 1e-9);
  EXPECT_NEAR(s.sigma, 2 * 0.01 * x, 1e-6 * x);
}

// The closest point lies between stations.
TEST(Separations, ClosestPointBetweenStations) {
  const Known a(Straight({0, 0, 0}, kPi / 2, 0), Propagation::kSystematic);
  const Known b(Straight({-70, 40, 0}, kPi / 2, 0), Propagation::kSystematic);
  const auto all = Separations(a.view(), b.view(), Pairing::kTwoWells);
  EXPECT_NEAR(all[5].other_md, 570, 1e-9);
  EXPECT_NEAR(all[5].distance, 40, 1e-9);
  const auto same = Separations(a.view(), b.view(), Pairing::kSameHole);
  EXPECT_NEAR(same[5].distance, std::hypot(70, 40), 1e-9);
}

TEST(Separations, WhereNothingIsUncertainThereIsNoNumberOfSigmas) {
  const Known a(Straight({0, 0, 0}, 1, 0), Propagation::kSystematic);
  const Known b(Straight({0, 9, 0}, 1, 0), Propagation::kSystematic);
  EXPECT_FALSE(Separations(a.view(), b.view(), Pairing::kSameHole)[0].sigmas);
  const auto met = Separations(a.view(), a.view(), Pairing::kTwoWells);
  EXPECT_EQ(met[3].distance, 0);
  EXPECT_GT(met[3].sigma, 0);
  EXPECT_EQ(*met[3].sigmas, 0);
}

}  // namespace
}  // namespace wellgyro
