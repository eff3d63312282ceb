#include "wellgyro/simulate/truth_well.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "wellgyro/math/rotation.h"

#include "cases.h"

namespace wellgyro {
namespace {

using Vector3L = Eigen::Matrix<long double, 3, 1>;

// Earth-centred position of a place on WGS 84.
Vector3L EarthCentred(const HolePlace& place) {
  const long double f = 1 / 298.257223563L, e2 = f * (2 - f), latitude = place.latitude;
  const long double s = std::sin(latitude), c = std::cos(latitude);
  const long double n = 6378137.0L / std::sqrt(1 - e2 * s * s), longitude = place.longitude;
  const long double h = place.height();
  return {(n + h) * c * std::cos(longitude), (n + h) * c * std::sin(longitude),
          (n * (1 - e2) + h) * s};
}

// Rows of L in the Earth's axes.
Eigen::Matrix3d NorthEastDown(const HolePlace& place) {
  return RotationZ(place.longitude) * RotationY(-kPi / 2 - place.latitude);
}

const SimulatedEarth kEarth{.latitude = FromDegrees(60), .longitude = 0.1, .height = 50};

TEST(TruthWell, PlacesFollowTheTangentOnTheEllipsoid) {
  for (const SimulatedWell& shape : {WeavingWell(), StationWell()}) {
    const TruthWell well(shape, kEarth);
    const double h = 1;
    for (double md = well.begin_md() + 5; md < well.end_md() - 5; md += 41.3) {
      const auto at = [&](double d) { return EarthCentred(well.PlaceAt(md + d)); };
      const Vector3L slope = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
      const Eigen::Vector3d expected =
          NorthEastDown(well.PlaceAt(md)) * well.DirectionAt(md).tangent_L;
      // The difference sees third derivatives jump at the joints; elsewhere it is good to 1e-8.
      EXPECT_LT((slope.cast<double>() - expected).norm(), 1e-7) << md;
    }
  }
}

TEST(TruthWell, SumsTheTangentTurnedByTheMeridiansConvergence) {
  // Midpoint sums in long double with the convergence as the integral of sin(latitude) d longitude.
  const TruthWell well(WeavingWell(), kEarth);
  const int steps = 50000;
  const long double h = (2600.0L - 100) / steps;
  Vector3L p = Vector3L::Zero();
  long double convergence = 0;
  double longitude = kEarth.longitude;
  for (int i = 0; i < steps; ++i) {
    const double md = static_cast<double>(100 + (i + 0.5L) * h);
    const Eigen::Vector3d t = well.DirectionAt(md).tangent_L;
    const HolePlace end = well.PlaceAt(md + static_cast<double>(h) / 2);
    const long double half = std::sin(well.PlaceAt(md).latitude) * (end.longitude - longitude) / 2;
    convergence += half;
    const long double c = std::cos(convergence), s = std::sin(convergence);
    p += h * Vector3L(c * t.x() + s * t.y(), c * t.y() - s * t.x(), t.z());
    convergence += half;
    longitude = end.longitude;
    if (i % 2000 != 1999) continue;
    const HolePlace place = well.PlaceAt(md + static_cast<double>(h) / 2);
    EXPECT_LT((p.cast<double>() - place.p_WT_W).norm(), 1e-6);
    EXPECT_NEAR(place.convergence, static_cast<double>(convergence), 1e-12);
  }
  EXPECT_GT(convergence, 1e-4) << "too little to be tested";
}

TEST(TruthWell, AnArcInTheMeridianIsAnArc) {
  SimulatedWell shape;
  shape.end_md = 1500;
  shape.inclination = {.start = 0, .terms = {{.rate = 0.001}}};
  const TruthWell well(shape, kEarth);
  for (double md = 0; md <= 1500; md += 37.7) {
    const Eigen::Vector3d p = well.PlaceAt(md).p_WT_W;
    EXPECT_NEAR(p.x(), 1000 * (1 - std::cos(md / 1000)), 1e-9);
    EXPECT_NEAR(p.y(), 0, 1e-12);
    EXPECT_NEAR(p.z(), 1000 * std::sin(md / 1000), 1e-9);
    EXPECT_NEAR(well.PlaceAt(md).height(), 50 - p.z(), 1e-9);
  }
}

// Due east at its own meridian everywhere is a parallel, which W sees bend to the north.
TEST(TruthWell, DueEastIsAParallel) {
  SimulatedWell shape;
  shape.end_md = 5000;
  shape.inclination.start = kPi / 2;
  shape.azimuth.start = kPi / 2;
  const TruthWell well(shape, kEarth);
  const HolePlace end = well.PlaceAt(5000);
  EXPECT_NEAR(end.latitude, kEarth.latitude, 1e-15);
  const double convergence = (end.longitude - kEarth.longitude) * std::sin(kEarth.latitude);
  EXPECT_NEAR(end.convergence, convergence, 1e-13);
  EXPECT_NEAR(ToDegrees(convergence), 0.0776, 0.0005);
  EXPECT_NEAR(end.p_WT_W.x(), 5000 * (1 - std::cos(convergence)) / convergence, 1e-8);
  EXPECT_NEAR(end.p_WT_W.y(), 5000 * std::sin(convergence) / convergence, 1e-8);
}

TEST(TruthWell, BeginsWhereItIsToldTo) {
  SimulatedWell shape = WeavingWell();
  shape.begin_p_WT_W = {1000, 2000, 90};
  const TruthWell well(shape, kEarth);
  const HolePlace begin = well.PlaceAt(100);
  EXPECT_EQ(begin.p_WT_W, shape.begin_p_WT_W);
  EXPECT_NEAR(begin.height(), -40, 1e-12);
  EXPECT_NEAR((begin.latitude - kEarth.latitude) * 6.39e6, 1000, 5);
  EXPECT_NEAR(begin.convergence, (begin.longitude - kEarth.longitude) * std::sin(kEarth.latitude),
              1e-6 * begin.convergence);
}

TEST(TruthWell, RefusesThePole) {
  EXPECT_THROW(TruthWell(WeavingWell(), {.latitude = FromDegrees(89.95)}), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro
