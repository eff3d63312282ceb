#include "wellgyro/calibration/trigonometric.h"

#include <cmath>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/calibration/bench_axes.h"
#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

Eigen::Vector3d Gravity(double inclination, double toolface) {
  return {-std::sin(inclination) * std::sin(toolface), -std::sin(inclination) * std::cos(toolface),
          std::cos(inclination)};
}

TrigonometricModel Model() {
  TrigonometricModel model;
  model.x = {{{0.013, 1.04, -1.1, 0.004},
              {0.011, 0.97, 0.8, -0.003},
              {0.012, 1.02, 2.2, 0.006},
              {520, 1.03, 0.5, 150},
              {610, 0.98, -2.0, -220},
              {480, 1.05, 1.4, 90}}};
  return model;
}

TEST(Trigonometric, FindsTheAnglesThatItsErrorsDependOn) {
  const TrigonometricModel model = Model();
  int turns = 0, cases = 0;
  for (const double inc : {10.0, 30.0, 60.0, 90.0, 120.0}) {
    for (int k = 0; k < 24; ++k) {
      const double i = FromDegrees(inc), t = FromDegrees(15.0 * k);
      const Eigen::Matrix<double, 6, 1> errors = TrigonometricErrors(model, i, t);
      const Eigen::Vector3d G = Gravity(i, t), M(2e4, -3e4, 3.5e4);
      const CorrectedReading found =
          Correct(model, G + errors.head<3>(), M + errors.tail<3>(), AffineModel{});
      ASSERT_FALSE(found.fell_back) << inc << " " << k;
      // The frequencies are not whole: across toolface zero the model has a step of its own.
      if (k == 0) continue;
      EXPECT_LT((found.G_B - G).norm(), 1e-10) << inc << " " << k;
      EXPECT_LT((found.M_B - M).norm(), 1e-6);
      EXPECT_NEAR(found.inclination, i, 1e-10);
      turns += found.turns;
      ++cases;
    }
  }
  EXPECT_LT(turns / cases, 20);
}

TEST(Trigonometric, FallsBackToTheAffineModelNearVertical) {
  AffineModel affine;
  affine.b_G = {0.004, -0.003, 0.006};
  affine.sensitivity_G(0, 2) = -0.012;
  const Eigen::Vector3d G = Gravity(FromDegrees(0.5), 1.0);
  const CorrectedReading found =
      Correct(Model(), affine.sensitivity_G * G + affine.b_G, Eigen::Vector3d(2e4, 0, 4e4), affine);
  EXPECT_TRUE(found.fell_back);
  EXPECT_LT((found.G_B - G).norm(), 1e-14);
}

TEST(Trigonometric, AgreesWithAffineErrorsOnItsOwnGreatCirclesOnly) {
  AffineModel affine;
  affine.sensitivity_G << 1.006, 0.004, -0.012, -0.005, 0.992, 0.009, 0.011, -0.007, 1.005;
  affine.sensitivity_M << 0.993, 0.006, 0.01, 0.004, 1.009, -0.008, -0.006, 0.012, 0.996;
  affine.b_G = {0.004, -0.003, 0.006};
  affine.b_M = {150, -220, 90};
  const double B = 5e4, D = FromDegrees(60);
  const TrigonometricModel model = FromAffine(affine, B, D);
  const auto errors = [&](double inc, double az, double tf) {
    const Eigen::Matrix3d R = BenchFromLevel(BenchAxes::kTrade, inc, az, tf);
    const Eigen::Vector3d G = R.col(2),
                          M = R * Eigen::Vector3d(B * std::cos(D), 0, B * std::sin(D));
    Eigen::Matrix<double, 6, 1> e;
    e << affine.sensitivity_G * G + affine.b_G - G, affine.sensitivity_M * M + affine.b_M - M;
    return e;
  };
  for (int k = 0; k < 12; ++k) {
    const double a = FromDegrees(30.0 * k);
    const auto one = errors(a, 0, kPi / 2), two = errors(a, 0, 0);
    const auto three = errors(kPi / 2, 1.5 * kPi, a);
    const auto m1 = TrigonometricErrors(model, a, kPi / 2), m2 = TrigonometricErrors(model, a, 0);
    const auto m3 = TrigonometricErrors(model, kPi / 2, a);
    EXPECT_NEAR(m1[0], one[0], 1e-15);
    EXPECT_NEAR(m1[3], one[3], 1e-9);
    EXPECT_NEAR(m2[1], two[1], 1e-15);
    EXPECT_NEAR(m2[4], two[4], 1e-9);
    EXPECT_NEAR(m3[2], three[2], 1e-15);
    EXPECT_NEAR(m3[5], three[5], 1e-9);
  }
  // At the opposite toolface the part of Gx along z has the wrong sign: twice 12 mg.
  const double inc = FromDegrees(2);
  const double left = errors(inc, 0, 1.5 * kPi)[0] - TrigonometricErrors(model, inc, 1.5 * kPi)[0];
  EXPECT_NEAR(left, 2 * -0.012 * std::cos(inc), 1e-4);
}

TEST(BenchAxes, TradeIsTheToolTurnedByAQuarter) {
  Random random(1);
  for (int k = 0; k < 20; ++k) {
    const double i = kPi * random.Uniform(), a = kTwoPi * random.Uniform(),
                 t = kTwoPi * random.Uniform();
    const Eigen::Vector3d trade = BenchFromLevel(BenchAxes::kTrade, i, a, t).col(2);
    EXPECT_LT((trade - Gravity(i, t)).norm(), 1e-14);
    // At rest f_T = g (sin I cos T, -sin I sin T, -cos I).
    const Eigen::Vector3d f_T = -BenchFromLevel(BenchAxes::kTool, i, a, t).col(2);
    EXPECT_LT(
        (f_T - Eigen::Vector3d(std::sin(i) * std::cos(t), -std::sin(i) * std::sin(t), -std::cos(i)))
            .norm(),
        1e-14);
    EXPECT_LT((ToolFromBench(BenchAxes::kTrade) * -trade - f_T).norm(), 1e-14);
    for (const BenchAxes axes : {BenchAxes::kTrade, BenchAxes::kTool}) {
      const Eigen::Matrix3d R = BenchFromLevel(axes, i, a, t);
      const MagneticAngles angles = AnglesOf(axes, R.col(2), R * Eigen::Vector3d(0.5, 0, 0.8));
      EXPECT_NEAR(angles.inclination, i, 1e-12);
      EXPECT_NEAR(WrapPi(angles.toolface - t), 0, 1e-12);
      EXPECT_NEAR(WrapPi(angles.azimuth - a), 0, 1e-12);
    }
  }
}

}  // namespace
}  // namespace wellgyro
