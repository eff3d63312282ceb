#include "wellgyro/survey/hole_attitude.h"

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
  const HoleAttitude hole = AttitudeOfHole(Tool(35, 310, 77), {});
  EXPECT_NEAR(hole.inclination, FromDegrees(35), 1e-15);
  EXPECT_NEAR(hole.azimuth, FromDegrees(310), 1e-14);
}

TEST(HoleAttitude, ASaggingToolReadsLessInclinationThanTheHoleHas) {
  StringSpec string;
  string.sag = FromDegrees(0.2);
  const HoleAttitude horizontal = AttitudeOfHole(Tool(90, 45, 10), string);
  EXPECT_NEAR(horizontal.inclination, FromDegrees(90) + std::atan(FromDegrees(0.2)), 1e-14);
  const HoleAttitude vertical = AttitudeOfHole(Tool(0, 45, 10), string);
  EXPECT_NEAR(vertical.inclination, 0, 1e-15);
}

TEST(HoleAttitude, ALeanTowardsTheMarkFollowsTheToolface) {
  StringSpec string;
  string.misalignment_x = FromDegrees(0.1);
  // The mark is up: the tool axis leans up, the hole lies below it.
  EXPECT_NEAR(AttitudeOfHole(Tool(60, 20, 0), string).inclination,
              FromDegrees(60) - std::atan(FromDegrees(0.1)), 1e-14);
  // The mark is to the right: the hole lies to the left, azimuth smaller by lean / sin I.
  const HoleAttitude right = AttitudeOfHole(Tool(60, 20, 90), string);
  EXPECT_NEAR(right.azimuth, FromDegrees(20 - 0.1 / std::sin(FromDegrees(60))), 1e-7);
}

TEST(HoleAttitude, TheTangentIsThatOfTheAnglesAndSeesALeanAtVertical) {
  StringSpec string;
  string.misalignment_x = FromDegrees(0.1);
  string.misalignment_y = FromDegrees(-0.05);
  string.sag = FromDegrees(0.2);
  for (double inclination : {0.0, 1e-6, 0.1, 3.0, 90.0, 120.0, 180.0}) {
    const HoleAttitude hole = AttitudeOfHole(Tool(inclination, 200, 70), string);
    const Eigen::Vector3d by_angles(std::sin(hole.inclination) * std::cos(hole.azimuth),
                                    std::sin(hole.inclination) * std::sin(hole.azimuth),
                                    std::cos(hole.inclination));
    EXPECT_LT((hole.tangent_L - by_angles).norm(), 4e-16) << inclination;
  }
  // Straight down with the mark to the north, the hole leans by what the tool does, the other way.
  const HoleAttitude hole = AttitudeOfHole(Tool(0, 0, 0), string);
  const Eigen::Vector3d axis(-FromDegrees(0.1), FromDegrees(0.05), 1);
  EXPECT_LT((hole.tangent_L - axis / axis.norm()).norm(), 4e-16);
}

TEST(HoleAttitude, SigmasGrowWithTheStringAndStopAtNoKnowledge) {
  StringSpec string;
  string.sigma_misalignment = 1e-3;
  string.sigma_sag = 2e-3;
  const HoleAttitude hole = AttitudeOfHole(Tool(30, 0, 0), string);
  EXPECT_NEAR(hole.cov(0, 0), 1e-6 + 1e-6, 1e-12);
  EXPECT_NEAR(hole.cov(1, 1), 4e-6, 1e-12);
  EXPECT_DOUBLE_EQ(AttitudeOfHole(Tool(0, 0, 0), string).cov(1, 1), kPi * kPi / 3);
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
