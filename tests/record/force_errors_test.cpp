#include "wellgyro/record/force_errors.h"

#include <cmath>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

// Errors of three axes drawn one by one, in the frame of the accelerometers: about the gyros' it is
// turned by half of what x and y lean apart.
TEST(ForceErrors, AreThoseOfAxesThatLeanAndScale) {
  const ErrorPriors errors{.accel_bias_sigma = 5e-4,
                           .accel_scale_sigma = 5e-5,
                           .accel_misalignment_sigma = 1e-4,
                           .roll_offset_sigma = 3e-4};
  const Eigen::Vector3d f(3, -4, -8);
  Random random(1);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double turned = 0;
  constexpr int kDraws = 40000;
  for (int i = 0; i < kDraws; ++i) {
    Eigen::Matrix3d A;
    Eigen::Vector3d bias;
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) A(j, k) = (j == k ? 5e-5 : 1e-4) * random.Normal();
      bias[j] = 5e-4 * random.Normal();
    }
    const double turn = 0.5 * (A(0, 1) - A(1, 0));
    A(0, 1) -= turn;
    A(1, 0) += turn;
    const Eigen::Vector3d off = A * f + bias;
    sum += off * off.transpose() / kDraws;
    turned += std::pow(turn + 3e-4 * random.Normal(), 2) / kDraws;
  }
  const Eigen::Matrix<double, 3, kForceErrors> by = ForceErrors(errors, f);
  // Variances of so many draws are known to 0.7 %, products of independent ones to 0.5 %.
  EXPECT_LT(((by * by.transpose() - sum).array().abs() /
             (sum.diagonal() * sum.diagonal().transpose()).array().sqrt())
                .maxCoeff(),
            0.03);
  EXPECT_NEAR(std::sqrt(turned) / ToolfaceOffsetSigma(errors), 1, 0.015);
}

}  // namespace
}  // namespace wellgyro
