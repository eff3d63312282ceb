// What the accelerometers' second order does to a knot's force, against what it does to the
// samples.
#include "wellgyro/estimate/second_order.h"

#include <algorithm>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "attitude/tool_motion.h"

namespace wellgyro {
namespace {

struct EvenRoll {
  const char* name;
  double inclination_deg, rpm;
  bool has_gz;
  double seconds;  ///< of a knot
};

// By gravity alone the error winds psi itself within a knot, by some part of the square of its
// turn: a slow one. By a third gyro psi is what it is, whatever the turn: here 60 deg a knot.
constexpr EvenRoll kRolls[] = {{"at_rest", 40, 0, false, 2},
                               {"turning_slowly", 70, 0.5, false, 2},
                               {"turning", 40, 5, true, 2},
                               {"turning_back", 110, -8, true, 1}};

class SecondOrder : public testing::TestWithParam<EvenRoll> {};

TEST_P(SecondOrder, DoesWhatTheColumnsSay) {
  const EvenRoll& c = GetParam();
  const motion::Attitude attitude = motion::InHole(c.inclination_deg, motion::Turning(c.rpm));
  const double begin = 3 * c.seconds;
  const auto fly = [&](int source, double error) {
    motion::Sensing sensing;
    sensing.has_gz = c.has_gz;
    sensing.error(source) = error;
    const auto samples = motion::Samples(attitude, sensing, 20, 6 * c.seconds);
    return motion::Increments(samples, c.seconds, IncrementOptions())[3];
  };
  for (int source = kAccelSecondOrder; source < kErrorSources; ++source) {
    const double size = 1e-6;
    const Increment plus = fly(source, size), minus = fly(source, -size);
    Eigen::Vector3d by_error = ForceBySecondOrder(plus).col(source - kAccelSecondOrder);
    by_error.head<2>() = Eigen::Rotation2Dd(plus.roll_before) * by_error.head<2>();
    const Eigen::Vector3d force = (motion::AtBegin(plus, attitude, begin).force -
                                   motion::AtBegin(minus, attitude, begin).force) /
                                  (2 * size);
    // A product of forces that happens to be small at this toolface is measured by the others.
    constexpr double kLeast = 0.05 * motion::kGravity * motion::kGravity;
    EXPECT_LT((force - by_error).norm(), 0.02 * std::max(by_error.norm(), kLeast))
        << source - kAccelSecondOrder << ": " << force.transpose() << " for "
        << by_error.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Motions, SecondOrder, testing::ValuesIn(kRolls),
                         [](const auto& at) { return std::string(at.param.name); });

}  // namespace
}  // namespace wellgyro
