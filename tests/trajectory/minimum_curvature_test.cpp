#include "wellgyro/trajectory/minimum_curvature.h"

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "wellgyro/base/units.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

using Vector3l = Eigen::Matrix<long double, 3, 1>;

Vector3l LongTangent(long double inclination, long double azimuth) {
  return {std::sin(inclination) * std::cos(azimuth), std::sin(inclination) * std::sin(azimuth),
          std::cos(inclination)};
}

// The arc by its centre and radius, in long double: another road than the library's. Both tangents
// come from the angles in long double, so that rounding of the tangents counts as the library's.
Vector3l ArcByItsCentre(long double length, const Vector3l& t1, const Vector3l& t2) {
  const Vector3l axis = t1.cross(t2);
  const long double dogleg = std::atan2(axis.norm(), t1.dot(t2));
  if (dogleg == 0) return length * t1;
  const Vector3l to_centre = (axis / axis.norm()).cross(t1);
  const long double radius = length / dogleg;
  return radius * (std::sin(dogleg) * t1 + (1 - std::cos(dogleg)) * to_centre);
}

struct Attitudes {
  double inclination_1, azimuth_1, inclination_2, azimuth_2;  // [rad]
};

std::vector<Attitudes> Legs() {
  std::vector<Attitudes> legs;
  for (const double size : {1e-3, 1e-2, 0.019, 0.021, 0.1, 1.0, 2.5, 3.1}) {
    legs.push_back({0, 0, size, 2.0});
    legs.push_back({0.5, 6.2, 0.5 + size, 6.2});
    legs.push_back({kPi / 2, 6.28, kPi / 2, 6.28 + size});
    legs.push_back({2.0, 1.0, 2.0 - 0.5 * size, 1.0 - 0.5 * size});
  }
  return legs;
}

TEST(MinimumCurvatureLeg, IsTheCircularArcTangentToBothStations) {
  for (const Attitudes& a : Legs()) {
    const auto leg = MinimumCurvatureLeg(30, Tangent(a.inclination_1, a.azimuth_1),
                                         Tangent(a.inclination_2, a.azimuth_2));
    ASSERT_TRUE(leg);
    const Vector3l t1 = LongTangent(a.inclination_1, a.azimuth_1);
    const Vector3l t2 = LongTangent(a.inclination_2, a.azimuth_2);
    const Vector3l truth = ArcByItsCentre(30, t1, t2);
    EXPECT_LT((leg->displacement.cast<long double>() - truth).norm(), 1e-13L) << leg->dogleg;
    const long double dogleg = std::atan2(t1.cross(t2).norm(), t1.dot(t2));
    EXPECT_NEAR(leg->dogleg, static_cast<double>(dogleg), 1e-15);
  }
}

TEST(MinimumCurvatureLeg, SmallDoglegsLoseNothing) {
  for (const double dogleg : {1e-12, 1e-9, 1e-7, 1e-5}) {
    const auto leg = MinimumCurvatureLeg(30, Tangent(0, 0), Tangent(dogleg, 0));
    ASSERT_TRUE(leg);
    EXPECT_NEAR(leg->dogleg / dogleg, 1, 1e-15);
    EXPECT_NEAR(leg->displacement.x() / (15 * dogleg), 1, 1e-10);
  }
}

TEST(MinimumCurvatureLeg, WithoutDoglegIsStraight) {
  const Eigen::Vector3d t = Tangent(0.7, 5.0);
  const auto leg = MinimumCurvatureLeg(12.5, t, t);
  ASSERT_TRUE(leg);
  EXPECT_EQ(leg->dogleg, 0);
  EXPECT_EQ(leg->displacement, Eigen::Vector3d(12.5 * t));
}

TEST(MinimumCurvatureLeg, OppositeDirectionsHaveNoArc) {
  const Eigen::Vector3d t = Tangent(0.7, 5.0);
  EXPECT_FALSE(MinimumCurvatureLeg(30, t, -t));
  EXPECT_FALSE(MinimumCurvatureLeg(30, Tangent(0, 0), Tangent(kPi - 5e-7, 1)));
  EXPECT_TRUE(MinimumCurvatureLeg(30, Tangent(0, 0), Tangent(kPi - 2e-6, 1)));
}

TEST(MinimumCurvatureLeg, WhatIsNoNumberHasNoArc) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(MinimumCurvatureLeg(nan, Tangent(0, 0), Tangent(1, 0)));
  EXPECT_FALSE(MinimumCurvatureLeg(30, Tangent(nan, 0), Tangent(1, 0)));
}

TEST(TangentOnArc, KeepsToThePlaneAndTurnsEvenly) {
  for (const Attitudes& a : Legs()) {
    const Vector3l t1 = LongTangent(a.inclination_1, a.azimuth_1);
    const Vector3l t2 = LongTangent(a.inclination_2, a.azimuth_2);
    const Vector3l axis = t1.cross(t2).normalized();
    const long double dogleg = std::atan2(t1.cross(t2).norm(), t1.dot(t2));
    for (const double fraction : {0.0, 0.1, 0.5, 0.9, 1.0}) {
      const Vector3l truth =
          std::cos(dogleg * fraction) * t1 + std::sin(dogleg * fraction) * axis.cross(t1);
      const Eigen::Vector3d t = TangentOnArc(Tangent(a.inclination_1, a.azimuth_1),
                                             Tangent(a.inclination_2, a.azimuth_2), fraction);
      EXPECT_LT((t.cast<long double>() - truth).norm(), 1e-15L / (kPi - dogleg));
    }
  }
}

TEST(TangentOnArc, StraightLegsKeepTheirDirection) {
  const Eigen::Vector3d t = Tangent(1.1, 3.0);
  EXPECT_LT((TangentOnArc(t, t, 0.3) - t).norm(), 1e-16);
  const Eigen::Vector3d close = Tangent(1.1 + 1e-12, 3.0);
  EXPECT_NEAR((TangentOnArc(t, close, 0.25) - t).norm(), 0.25e-12, 3e-16);
}

TEST(MinimumCurvature, AddsItsLegs) {
  const std::vector<double> md{100, 130, 160.5};
  const std::vector<double> inclination{0.1, 0.3, 0.2};
  const std::vector<double> azimuth{6.2, 0.1, 0.4};
  std::vector<Eigen::Vector3d> position(3);
  std::vector<double> severity(3);
  MinimumCurvature(md, inclination, azimuth, {1, 2, 99}, position, severity);
  Vector3l at(1, 2, 99);
  EXPECT_EQ(position[0], Eigen::Vector3d(1, 2, 99));
  EXPECT_EQ(severity[0], 0);
  for (std::size_t i = 1; i < md.size(); ++i) {
    const Vector3l t1 = LongTangent(inclination[i - 1], azimuth[i - 1]);
    const Vector3l t2 = LongTangent(inclination[i], azimuth[i]);
    at += ArcByItsCentre(md[i] - md[i - 1], t1, t2);
    EXPECT_LT((position[i].cast<long double>() - at).norm(), 1e-13L);
    const long double dogleg = std::atan2(t1.cross(t2).norm(), t1.dot(t2));
    EXPECT_NEAR(severity[i], static_cast<double>(dogleg) / (md[i] - md[i - 1]), 1e-16);
  }
}

std::string MessageOf(std::vector<double> md, std::vector<double> inclination) {
  const std::vector<double> azimuth(md.size(), 0.5);
  std::vector<Eigen::Vector3d> position(md.size());
  try {
    MinimumCurvature(md, inclination, azimuth, {0, 0, 0}, position);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(MinimumCurvature, RefusesWithTheStationNamed) {
  using testing::HasSubstr;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(MessageOf({0, 10, 20}, {0, 0.1, 0.2}), "accepted");
  EXPECT_THAT(MessageOf({0, 10, 10}, {0, 0.1, 0.2}), HasSubstr("station 2"));
  EXPECT_THAT(MessageOf({0, 10, 9}, {0, 0.1, 0.2}), HasSubstr("station 2"));
  EXPECT_THAT(MessageOf({0, nan, 20}, {0, 0.1, 0.2}), HasSubstr("station 1"));
  EXPECT_THAT(MessageOf({0, 10, 20}, {nan, 0.1, 0.2}), HasSubstr("station 0"));
  EXPECT_THAT(MessageOf({0, 10, 20}, {0, 0.1, 0.1 - kPi}), HasSubstr("station 2"));
  EXPECT_THAT(MessageOf({0, 10, 20}, {0, 0.1}), HasSubstr("2 inclinations"));
}

// A commercial package's full-precision export: 1e-12-level TVD and dogleg severity, metres on the
// grid with its scale factor.
TEST(MinimumCurvature, RefusesAStartOrALengthThatIsNotFinite) {
  const std::array<double, 2> straight{0, 0};
  std::array<Eigen::Vector3d, 2> position;
  const auto why = [&](const std::array<double, 2>& md, double start) {
    try {
      MinimumCurvature(md, straight, straight, {start, 0, 0}, position);
    } catch (const std::invalid_argument& refused) {
      return std::string(refused.what());
    }
    return std::string();
  };
  EXPECT_EQ(why({0, 1}, 0), "");
  for (const double odd :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(why({0, 1}, odd), testing::HasSubstr("station 0"));
  }
  EXPECT_THAT(why({-1e308, 1e308}, 0), testing::HasSubstr("depth 1e+308 m after -1e+308 m"));
}

TEST(MinimumCurvature, AgreesWithACommercialExport) {
  std::ifstream file(WELLGYRO_REFERENCE_DIR "/wells/wellpathpy/well10.csv");
  if (!file) GTEST_SKIP() << "the reference data are not here";
  std::vector<double> md, inclination, azimuth;
  std::vector<std::array<double, 4>> truth;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::array<double, 7> v{};
    std::istringstream fields(line);
    std::string field;
    for (double& x : v) std::getline(fields, field, ','), x = std::stod(field);
    md.push_back(v[0] * units::kFoot);
    inclination.push_back(FromDegrees(v[1]));
    azimuth.push_back(FromDegrees(v[2]));
    truth.push_back({v[3] * units::kFoot, v[4] * units::kDegPer100ft, v[5], v[6]});
  }
  ASSERT_GT(md.size(), 50u);
  std::vector<Eigen::Vector3d> position(md.size());
  std::vector<double> severity(md.size());
  MinimumCurvature(md, inclination, azimuth, {0, 0, 0}, position, severity);
  constexpr double kGridScale = 0.99975273;  // given to 8 figures: 1e-8 of the 1 km offsets
  for (std::size_t i = 0; i < md.size(); ++i) {
    EXPECT_NEAR(position[i].z(), truth[i][0], 1e-8) << i;
    EXPECT_NEAR(severity[i], truth[i][1], 1e-10 * units::kDegPer30m) << i;
    EXPECT_NEAR(position[i].x() * kGridScale, truth[i][2] - truth[0][2], 2e-5) << i;
    EXPECT_NEAR(position[i].y() * kGridScale, truth[i][3] - truth[0][3], 2e-5) << i;
  }
}

}  // namespace
}  // namespace wellgyro
