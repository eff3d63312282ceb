#include "wellgyro/survey/hole/hole_attitude.h"

#include <cmath>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

AttitudeSample Tool(double inclination_deg, double azimuth_deg, double toolface_deg) {
  AttitudeSample tool;
  tool.inclination = FromDegrees(inclination_deg);
  tool.azimuth = FromDegrees(azimuth_deg);
  tool.toolface = FromDegrees(toolface_deg);
  tool.azimuth_known = true;
  return tool;
}

TEST(HoleAttitude, WithoutAStringTheToolIsTheHole) {
  const Eigen::Vector3d tangent_L = TangentOfHole(Tool(35, 310, 77), {});
  EXPECT_LT((tangent_L - Tangent(FromDegrees(35), FromDegrees(310))).norm(), 4e-16);
}

TEST(HoleAttitude, ASaggingToolReadsLessInclinationThanTheHoleHas) {
  StringSpec string;
  string.sag = FromDegrees(0.2);
  EXPECT_NEAR(InclinationOf(TangentOfHole(Tool(90, 45, 10), string)),
              FromDegrees(90) + std::atan(FromDegrees(0.2)), 1e-14);
  EXPECT_NEAR(InclinationOf(TangentOfHole(Tool(0, 45, 10), string)), 0, 1e-15);
}

TEST(HoleAttitude, ALeanTowardsTheMarkFollowsTheToolface) {
  StringSpec string;
  string.misalignment_x = FromDegrees(0.1);
  // The mark is up: the tool axis leans up, the hole lies below it.
  EXPECT_NEAR(InclinationOf(TangentOfHole(Tool(60, 20, 0), string)),
              FromDegrees(60) - std::atan(FromDegrees(0.1)), 1e-14);
  // The mark is to the right: the hole lies to the left, azimuth smaller by lean / sin I.
  EXPECT_NEAR(AzimuthOf(TangentOfHole(Tool(60, 20, 90), string)),
              FromDegrees(20 - 0.1 / std::sin(FromDegrees(60))), 1e-7);
}

TEST(HoleAttitude, ALeanIsSeenAtVertical) {
  StringSpec string;
  string.misalignment_x = FromDegrees(0.1);
  string.misalignment_y = FromDegrees(-0.05);
  string.sag = FromDegrees(0.2);
  // Straight down with the mark to the north, the hole leans by what the tool does, the other way.
  const Eigen::Vector3d axis(-FromDegrees(0.1), FromDegrees(0.05), 1);
  EXPECT_LT((TangentOfHole(Tool(0, 0, 0), string) - axis / axis.norm()).norm(), 4e-16);
}

TEST(HoleAttitude, TheCovarianceGrowsWithTheString) {
  StringSpec string;
  string.sigma_misalignment = 1e-3;
  string.sigma_sag = 2e-3;
  const Eigen::Vector3d tangent_L = TangentOfHole(Tool(30, 0, 0), string);
  const Eigen::Matrix3d cov = CovarianceOfTangent(tangent_L, Eigen::Matrix3d::Zero(), string);
  const Eigen::Vector3d high_side_L(std::cos(FromDegrees(30)), 0, -std::sin(FromDegrees(30)));
  EXPECT_NEAR(high_side_L.dot(cov * high_side_L), 1e-6 + 1e-6, 1e-12);
  EXPECT_NEAR(cov(1, 1), 1e-6, 1e-12) << "to the right: the lean alone";
  EXPECT_NEAR(tangent_L.dot(cov * tangent_L), 0, 1e-18);
}

TEST(HoleAttitude, DirectionOfMarkIsThatOfTheXAxis) {
  for (double toolface : {0.0, 30.0, 135.0, 260.0}) {
    const AttitudeSample tool = Tool(70, 200, toolface);
    const Eigen::Vector3d x_L =
        AttitudeMatrix(tool.azimuth, tool.inclination, tool.toolface).col(0);
    EXPECT_NEAR(WrapPi(DirectionOfMark(tool) - std::atan2(x_L.y(), x_L.x())), 0, 1e-14);
  }
}

}  // namespace
}  // namespace wellgyro
