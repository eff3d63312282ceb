#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/trajectory/leg_geometry.h"

namespace wellgyro {
namespace {

using Point = std::array<long double, 3>;

// The formulas as API Bulletin D20 prints them, in long double.
Point Printed(SurveyMethod method, long double length, long double i1, long double a1,
              long double i2, long double a2) {
  const long double i = (i1 + i2) / 2, a = (a1 + a2) / 2;
  switch (method) {
    case SurveyMethod::kAverageAngle:
      return {length * std::sin(i) * std::cos(a), length * std::sin(i) * std::sin(a),
              length * std::cos(i)};
    case SurveyMethod::kTangential:
      return {length * std::sin(i2) * std::cos(a2), length * std::sin(i2) * std::sin(a2),
              length * std::cos(i2)};
    case SurveyMethod::kBalancedTangential:
      return {length / 2 * (std::sin(i1) * std::cos(a1) + std::sin(i2) * std::cos(a2)),
              length / 2 * (std::sin(i1) * std::sin(a1) + std::sin(i2) * std::sin(a2)),
              length / 2 * (std::cos(i1) + std::cos(i2))};
    default:
      return {length * (std::cos(i1) - std::cos(i2)) * (std::sin(a2) - std::sin(a1)) /
                  ((i2 - i1) * (a2 - a1)),
              length * (std::cos(i1) - std::cos(i2)) * (std::cos(a1) - std::cos(a2)) /
                  ((i2 - i1) * (a2 - a1)),
              length * (std::sin(i2) - std::sin(i1)) / (i2 - i1)};
  }
}

constexpr std::array kClassic{SurveyMethod::kAverageAngle, SurveyMethod::kTangential,
                              SurveyMethod::kBalancedTangential, SurveyMethod::kRadiusOfCurvature};

std::vector<Eigen::Vector3d> Summed(SurveyMethod method, const std::vector<double>& inclination,
                                    const std::vector<double>& azimuth) {
  const std::vector<double> md{0, 30};
  std::vector<Eigen::Vector3d> position(2);
  PositionsBy(method, md, inclination, azimuth, {1, 2, 3}, position);
  return position;
}

TEST(ClassicMethods, AreThePrintedFormulas) {
  for (const SurveyMethod method : kClassic) {
    for (const double i2 : {0.02, 0.51, 1.3}) {
      for (const double a2 : {2.01, 2.6, 4.9}) {
        const Point truth = Printed(method, 30, 0.5, 2, i2, a2);
        const Eigen::Vector3d leg =
            Summed(method, {0.5, i2}, {2, a2})[1] - Eigen::Vector3d(1, 2, 3);
        for (const int k : {0, 1, 2}) {
          EXPECT_NEAR(leg[k], static_cast<double>(truth[static_cast<std::size_t>(k)]), 1e-13);
        }
      }
    }
  }
}

// Where the printed formula of radius of curvature has 0/0, it goes over into straight legs.
TEST(ClassicMethods, EqualAnglesAreStraight) {
  for (const SurveyMethod method : kClassic) {
    const Eigen::Vector3d leg = Summed(method, {0.5, 0.5}, {2, 2})[1] - Eigen::Vector3d(1, 2, 3);
    EXPECT_NEAR(leg.x(), 30 * std::sin(0.5) * std::cos(2.0), 1e-13);
    EXPECT_NEAR(leg.z(), 30 * std::cos(0.5), 1e-13);
  }
}

TEST(ClassicMethods, AverageAcrossNorthTheShortWay) {
  for (const SurveyMethod method : kClassic) {
    const Eigen::Vector3d leg = Summed(method, {0.5, 0.5}, {FromDegrees(359), FromDegrees(3)})[1] -
                                Eigen::Vector3d(1, 2, 3);
    EXPECT_NEAR(leg.x(), 30 * std::sin(0.5), 0.03);
    EXPECT_GT(leg.y(), 0);
  }
}

TEST(ClassicMethods, RefuseWithTheStationNamed) {
  const std::vector<double> md{0, 10, 10}, angle{0, 0, 0};
  std::vector<Eigen::Vector3d> position(3);
  try {
    PositionsBy(SurveyMethod::kAverageAngle, md, angle, angle, {0, 0, 0}, position);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("station 2"));
  }
}

}  // namespace
}  // namespace wellgyro
