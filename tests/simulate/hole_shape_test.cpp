#include "wellgyro/simulate/hole_shape.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "wellgyro/math/rotation.h"

#include "cases.h"

namespace wellgyro {
namespace {

Eigen::Vector3d SlopeByDifference(const HoleShape& shape, double md, double h) {
  return (8 * (shape.At(md + h).tangent_L - shape.At(md - h).tangent_L) -
          (shape.At(md + 2 * h).tangent_L - shape.At(md - 2 * h).tangent_L)) /
         (12 * h);
}

TEST(HoleShape, CurvatureIsTheSlopeOfAUnitTangent) {
  for (const SimulatedWell& well : {WeavingWell(), StationWell()}) {
    const HoleShape shape(well);
    for (double md = shape.begin_md() + 3.3; md < shape.end_md() - 3; md += 7.7) {
      const HoleDirection at = shape.At(md);
      EXPECT_NEAR(at.tangent_L.norm(), 1, 1e-14);
      EXPECT_LT((at.curvature_L - SlopeByDifference(shape, md, 0.1)).norm(), 2e-9) << md;
    }
  }
}

TEST(HoleShape, LawsAreWhatTheySay) {
  const HoleShape shape(WeavingWell());
  // Between the build's ramps, after half a ramp at full rate.
  const double md = 1000, built = FromDegrees(60) / 1140 * (md - 300 - 30);
  const double inclination =
      FromDegrees(3) + built + FromDegrees(0.4) * std::sin(kTwoPi * (md - 100) / 170 + 0.3);
  const double azimuth = FromDegrees(35) + FromDegrees(20) / 1000 * (md - 100) +
                         FromDegrees(15) * std::sin(kTwoPi * (md - 500) / 700);
  EXPECT_LT((shape.At(md).tangent_L - Tangent(inclination, azimuth)).norm(), 1e-14);
  // The build is over: 60 deg were built.
  EXPECT_NEAR(std::acos(shape.At(2600).tangent_L.z()),
              FromDegrees(63 + 0.4 * std::sin(kTwoPi * 2500 / 170 + 0.3)), 1e-13);
}

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

TEST(HoleShape, StationsArePassedAtASixthOfTheKink) {
  const SimulatedWell well = StationWell();
  const HoleShape shape(well);
  const auto tangent = [&](std::size_t i) {
    return Tangent(well.stations[i].inclination, well.stations[i].azimuth);
  };
  double worst = 0;
  for (std::size_t i = 1; i + 1 < well.stations.size(); ++i) {
    const auto bend = [&](std::size_t k) {
      return AngleBetween(tangent(k), tangent(k - 1)) /
             (well.stations[k].md - well.stations[k - 1].md);
    };
    const double distance = AngleBetween(shape.At(well.stations[i].md).tangent_L, tangent(i));
    // The change of curvature is at most the sum of both.
    EXPECT_LE(distance, (bend(i) + bend(i + 1)) * 10 / 6 * 1.001) << i;
    worst = std::max(worst, distance);
  }
  // The kick-off, from straight to 3 deg in 30 m.
  EXPECT_NEAR(worst, FromDegrees(3) / 30 * 10 / 6, 1e-4);
}

TEST(HoleShape, CurvatureHasASlopeThatDoesNotJump) {
  const HoleShape shape(StationWell());
  const double step = 1e-3;
  for (double md = 10; md < 1400; md += 10) {  // every knot, every station
    const Eigen::Vector3d at = shape.At(md).curvature_L;
    const Eigen::Vector3d after = (shape.At(md + step).curvature_L - at) / step;
    const Eigen::Vector3d before = (at - shape.At(md - step).curvature_L) / step;
    EXPECT_LT((after - before).norm(), 1e-7) << md;
    EXPECT_LT(after.norm(), 3e-4) << "no kink is hidden in a sharp bend";
  }
}

TEST(HoleShape, AVerticalTopIsVertical) {
  const HoleShape shape(StationWell());
  for (double md = 0; md < 380; md += 5) {
    EXPECT_EQ(shape.At(md).tangent_L, Eigen::Vector3d::UnitZ());
    EXPECT_EQ(shape.At(md).curvature_L, Eigen::Vector3d::Zero());
  }
}

TEST(HoleShape, AnArcStaysAnArc) {
  SimulatedWell well;
  well.stations = {{0, 0.1, 1}, {100, 0.3, 1}, {217, 0.534, 1}, {500, 1.1, 1}};
  const HoleShape shape(well);
  for (double md = 0; md <= 500; md += 3.3) {
    EXPECT_LT((shape.At(md).tangent_L - Tangent(0.1 + 0.002 * md, 1)).norm(), 1e-9) << md;
    EXPECT_NEAR(shape.At(md).curvature_L.norm(), 0.002, 1e-9) << md;
  }
}

// Arcs over the stations' spacing h miss a curvature that changes at the rate k' by k' h^2 / 8.
TEST(HoleShape, FollowsTheHoleTheStationsCameFrom) {
  SimulatedWell well;
  well.smoothing = 2;
  const auto inclination = [](double md) { return FromDegrees(40 + 30 * std::sin(md / 400)); };
  for (double md = 0; md <= 1500; md += 10) well.stations.push_back({md, inclination(md), 1.0});
  const HoleShape shape(well);
  const double bound = FromDegrees(30) / (400 * 400) * 100 / 8;
  for (double md = 0; md <= 1500; md += 3.1) {
    EXPECT_LT((shape.At(md).tangent_L - Tangent(inclination(md), 1.0)).norm(), bound) << md;
  }
}

template <class Change>
void ExpectRefused(SimulatedWell well, const std::string& names, Change change) {
  change(well);
  try {
    HoleShape shape(well);
    ADD_FAILURE() << "accepted: " << names;
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find(names), std::string::npos) << e.what();
  }
}

TEST(HoleShape, NamesWhatMakesNoSense) {
  ExpectRefused(StationWell(), "station 4", [](auto& w) { w.stations[3].md = 400; });
  ExpectRefused(StationWell(), "station 6", [](auto& w) { w.stations[5].inclination = 2; });
  ExpectRefused(StationWell(), "one station", [](auto& w) { w.stations.resize(1); });
  ExpectRefused(StationWell(), "smoothing", [](auto& w) { w.smoothing = 0; });
  ExpectRefused(StationWell(), "smoothing", [](auto& w) { w.smoothing = 1e-6; });
  ExpectRefused(WeavingWell(), "quarter periods", [](auto& w) { w.azimuth.terms[1].period = 0.2; });
  ExpectRefused(WeavingWell(), "end_md_m", [](auto& w) { w.end_md = 100; });
  ExpectRefused(WeavingWell(), "inclination.term]] 1: ramp_m",
                [](auto& w) { w.inclination.terms[0].ramp = 0; });
  ExpectRefused(WeavingWell(), "too short", [](auto& w) { w.inclination.terms[0].ramp = 700; });
  ExpectRefused(WeavingWell(), "azimuth.term]] 2: period_m",
                [](auto& w) { w.azimuth.terms[1].period = 0; });
  ExpectRefused(WeavingWell(), "straight up", [](auto& w) { w.inclination.start = 2.2; });
}

}  // namespace
}  // namespace wellgyro
