#include "wellgyro/survey/wells/separation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/survey/hole/well_uncertainty.h"
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

struct KnownLine {
  SurveyedWell well;
  ErrorModel model;
  PositionUncertainty errors;

  KnownLine(SurveyedWell surveyed, Propagation propagation)
      : well(std::move(surveyed)), model(OneTerm(propagation)) {
    const ToolLeg leg{&model, 0, well.survey.size(), 1};
    errors = PropagateErrors(well.survey, {}, std::span(&leg, 1));
  }
  HoleLine line() const { return HoleLine({&well, &errors}); }
};

std::vector<Separation> Shared(const KnownLine& a, const KnownLine& b, Pairing pairing) {
  SeparationRule rule;
  rule.correlation = Correlation::kGlobal;
  rule.minima = false;
  return Separations(a.line(), b.line(), pairing, rule);
}

// Two parallel wells, 50 m apart across: an azimuth error of 0.01 rad moves each across by 0.01 x.
// Each its own: sqrt(2) of it. The same global one: none of it.
TEST(Separations, SharedErrorsCancelBetweenParallelWells) {
  const double i = 1.2, x = 2000 * std::sin(i);
  const SurveyedWell a = Straight({0, 0, 0}, i, 0), b = Straight({0, 50, 0}, i, 0);
  const KnownLine own_a(a, Propagation::kSystematic), own_b(b, Propagation::kSystematic);
  const Separation own = Shared(own_a, own_b, Pairing::kTwoWells).back();
  EXPECT_NEAR(own.distance, 50, 1e-9);
  EXPECT_NEAR(own.vector_W.y(), 50, 1e-9);
  EXPECT_NEAR(own.other_md, 2000, 1e-6);
  EXPECT_NEAR(own.sigma, std::sqrt(2) * 0.01 * x, 1e-9 * x);
  EXPECT_NEAR(*own.sigmas, 50 / own.sigma, 1e-12);

  const KnownLine same_a(a, Propagation::kGlobal), same_b(b, Propagation::kGlobal);
  const Separation same = Shared(same_a, same_b, Pairing::kTwoWells).back();
  EXPECT_NEAR(same.sigma, 0, 1e-6);

  // Well-by-well errors are another well's own, but one hole's common.
  const KnownLine well_a(a, Propagation::kWell), well_b(b, Propagation::kWell);
  EXPECT_NEAR(Shared(well_a, well_b, Pairing::kTwoWells).back().sigma, own.sigma, 1e-9);
  EXPECT_NEAR(Shared(well_a, well_b, Pairing::kSameHole).back().sigma, 0, 1e-6);
}

// Antiparallel wells: the same azimuth error moves them apart, twice as far.
TEST(Separations, SharedErrorsAddBetweenOppositeWells) {
  const double i = kPi / 2, x = 2000;
  const KnownLine a(Straight({0, 0, 0}, i, 0), Propagation::kGlobal);
  const KnownLine b(Straight({4000, 30, 0}, i, kPi), Propagation::kGlobal);
  const Separation s = Shared(a, b, Pairing::kTwoWells).back();
  EXPECT_NEAR(s.distance, 30, 1e-9);
  EXPECT_NEAR(s.sigma, 2 * 0.01 * x, 1e-6 * x);
}

// The correlation is the caller's to choose.
TEST(Separations, CorrelationIsChosen) {
  const double i = 1.2, x = 2000 * std::sin(i);
  const SurveyedWell a = Straight({0, 0, 0}, i, 0), b = Straight({0, 50, 0}, i, 0);
  const auto sigma = [&](Propagation propagation, Correlation correlation) {
    const KnownLine first(a, propagation), second(b, propagation);
    SeparationRule rule;
    rule.correlation = correlation;
    return Separations(first.line(), second.line(), Pairing::kTwoWells, rule).back().sigma;
  };
  const double apart = std::sqrt(2) * 0.01 * x;
  EXPECT_NEAR(sigma(Propagation::kGlobal, Correlation::kNone), apart, 1e-9 * x);
  EXPECT_NEAR(sigma(Propagation::kGlobal, Correlation::kGlobal), 0, 1e-6);
  EXPECT_NEAR(sigma(Propagation::kWell, Correlation::kGlobal), apart, 1e-9 * x);
  EXPECT_NEAR(sigma(Propagation::kWell, Correlation::kFull), 0, 1e-6);
  EXPECT_NEAR(sigma(Propagation::kSystematic, Correlation::kFull), apart, 1e-9 * x);
}

/// A quarter of a circle of radius 100 m from straight down to north, in legs of 30 m or so, and
/// straight on.
SurveyedWell Bend(double start_tvd) {
  std::vector<SurveyPoint> stations;
  for (int k = 0; k <= 5; ++k) stations.push_back({10 * kPi * k, k * kPi / 10, 0, 0});
  stations.push_back({50 * kPi + 300, kPi / 2, 0, 0});
  return SurveyWell(stations, {0, 0, start_tvd});
}

// Outside a bend the true distance is that of the arcs: 2.000 m, not that of chords.
TEST(Separations, OutsideABendTheDistanceIsTheArcs) {
  const KnownLine bend(Bend(0), Propagation::kSystematic);
  // Through the point 2 m below the arc's own at 45 deg, half way between two stations, to east.
  const double c = 100 - 102 * std::sqrt(0.5), z = 102 * std::sqrt(0.5);
  const KnownLine across(Straight({c, -1015, z}, kPi / 2, kPi / 2), Propagation::kSystematic);
  const auto rows = Separations(across.line(), bend.line(), Pairing::kTwoWells, SeparationRule{});
  double nearest = 1e9;
  for (const Separation& s : rows) nearest = std::min(nearest, s.distance);
  EXPECT_NEAR(nearest, 2, 1e-6);
  const auto found = std::ranges::find(rows, Separation::Kind::kNearest, &Separation::kind);
  ASSERT_NE(found, rows.end());
  EXPECT_NEAR(found->md, 1015, 1e-3);
  EXPECT_NEAR(found->other_md, 25 * kPi, 1e-3);
}

TEST(Separations, HorizontalAndTravellingCylinder) {
  const KnownLine level(Straight({0, 0, 1000}, kPi / 2, 0), Propagation::kSystematic);
  const KnownLine steep(Straight({500, 30, 0}, kPi / 4, 0), Propagation::kSystematic);
  SeparationRule rule;
  rule.scan = Scan::kTravellingCylinder;
  const auto across = Separations(level.line(), steep.line(), Pairing::kTwoWells, rule);
  for (const Separation& s : across) EXPECT_NEAR(s.vector_W.x(), 0, 1e-9);
  // North 500 to 1914 only is within the steep one's reach.
  ASSERT_EQ(across.size(), 15U);
  EXPECT_NEAR(across[0].distance, std::hypot(30, 1000), 1e-9);
  // Above the level hole and to the east: from the high side to the right.
  EXPECT_NEAR(across[0].toolface, std::atan2(30, 1000), 1e-12);
  rule.scan = Scan::kHorizontal;
  const auto flat = Separations(steep.line(), level.line(), Pairing::kTwoWells, rule);
  EXPECT_TRUE(flat.empty());  // no station of the steep one is at TVD 1000
  const KnownLine upright(Straight({700, 0, 0}, 0, 0), Propagation::kSystematic);
  const auto at_tvd = Separations(upright.line(), steep.line(), Pairing::kTwoWells, rule);
  ASSERT_GE(at_tvd.size(), 10U);
  EXPECT_NEAR(at_tvd[2].distance, std::hypot(0, 30), 1e-9);  // TVD 200: 500 + 200 north
}

// Straight down the vector both surfaces agree; across an elongated ellipsoid the pedal curve is
// the wider.
TEST(Separations, PedalCurveAndEllipsoid) {
  const KnownLine a(Straight({0, 0, 0}, kPi / 2, 0), Propagation::kSystematic);
  const KnownLine b(Straight({0, 40, 30}, kPi / 2, 0), Propagation::kSystematic);
  SeparationRule rule;
  const auto pedal = Separations(a.line(), b.line(), Pairing::kTwoWells, rule).back();
  rule.surface = ErrorSurface::kEllipsoid;
  const auto exact = Separations(a.line(), b.line(), Pairing::kTwoWells, rule).back();
  // At 2000 m either well is uncertain by 20 m to the east and by nothing down.
  const double east = 2 * 400.0, ahead = 0.25;
  EXPECT_NEAR(pedal.factor.value(), (50 - 0.3) / (3.5 * std::sqrt(0.64 * east + ahead)), 1e-6);
  const double y = 40 * 49.7 / 50, z = 30 * 49.7 / 50;
  EXPECT_NEAR(exact.factor.value(), std::sqrt(y * y / (east + ahead) + z * z / ahead) / 3.5, 1e-6);
  EXPECT_GT(*exact.factor, *pedal.factor);
  EXPECT_NEAR(pedal.allowed, 3.5 * std::sqrt(0.64 * east + ahead) + 0.3, 1e-6);
}

TEST(Separations, ScreenedOutIsNeverBelow) {
  const SeparationRule rule;
  int kept = 0, left = 0;
  for (int i = 0; i < 60; ++i) {
    const double away = 4.0 * i;
    const KnownLine a(Straight({0, 0, 0}, 1.0, 0.2), Propagation::kSystematic);
    const KnownLine b(Straight({100, away, 0}, 1.1, 0.2 + 0.01 * (i % 7)),
                      Propagation::kSystematic);
    const auto rows = Separations(a.line(), b.line(), Pairing::kTwoWells, rule);
    const double lowest = Lowest(rows)->factor.value();
    if (MayFallBelow(a.line(), b.line(), rule, 2)) {
      ++kept;
    } else {
      EXPECT_GE(lowest, 2) << i;
      ++left;
    }
  }
  EXPECT_GT(kept, 5);
  EXPECT_GT(left, 20);
}

// The closest point lies between stations.
TEST(Separations, ClosestPointBetweenStations) {
  const KnownLine a(Straight({0, 0, 0}, kPi / 2, 0), Propagation::kSystematic);
  const KnownLine b(Straight({-70, 40, 0}, kPi / 2, 0), Propagation::kSystematic);
  const auto all = Shared(a, b, Pairing::kTwoWells);
  EXPECT_NEAR(all[5].other_md, 570, 1e-9);
  EXPECT_NEAR(all[5].distance, 40, 1e-9);
  const auto same = Shared(a, b, Pairing::kSameHole);
  EXPECT_NEAR(same[5].distance, std::hypot(70, 40), 1e-9);
}

TEST(Separations, WhereNothingIsUncertainThereIsNoNumberOfSigmas) {
  const KnownLine a(Straight({0, 0, 0}, 1, 0), Propagation::kSystematic);
  const KnownLine b(Straight({0, 9, 0}, 1, 0), Propagation::kSystematic);
  EXPECT_FALSE(Shared(a, b, Pairing::kSameHole)[0].sigmas);
  const auto met = Shared(a, a, Pairing::kTwoWells);
  EXPECT_EQ(met[3].distance, 0);
  EXPECT_GT(met[3].sigma, 0);
  EXPECT_EQ(*met[3].sigmas, 0);
}

}  // namespace
}  // namespace wellgyro
