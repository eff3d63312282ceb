#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/fit/shift_estimate_internal.h"
#include "wellgyro/math/random.h"

namespace wellgyro::test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd Any(Random& random, Index rows, Index columns) {
  return MatrixXd::NullaryExpr(rows, columns, [&] { return random.Normal(); });
}

// The covariance of all residuals written out, as the definition has it.
struct Dense {
  MatrixXd C, B, F;
  VectorXd e;

  void Add(const MatrixXd& cov_noise, const MatrixXd& more_F, const MatrixXd& more_B,
           const VectorXd& more_e) {
    const Index n = e.size(), more = more_e.size();
    for (MatrixXd* whole : {&B, &F}) {
      const MatrixXd& add = whole == &B ? more_B : more_F;
      whole->conservativeResize(n + more, add.cols());
      whole->bottomRows(more) = add;
    }
    e.conservativeResize(n + more);
    e.tail(more) = more_e;
    MatrixXd wider = MatrixXd::Zero(n + more, n + more);
    if (n > 0) wider.topLeftCorner(n, n) = C;
    wider.bottomRightCorner(more, more) = cov_noise;
    C = wider;
  }
};

TEST(ToolShiftEstimate, IsThatOfTheWholeCovariance) {
  Random random(3);
  constexpr Index kCommon = 12, kShifts = 6;
  ToolShiftEstimator estimator(kCommon, kShifts);
  Dense dense;
  const MatrixXd root = Any(random, kCommon, kCommon - 3);  // singular, of sizes far apart
  const VectorXd size =
      VectorXd::LinSpaced(kCommon, -9, 3).unaryExpr([](double x) { return std::pow(10, x); });
  const MatrixXd cov = size.asDiagonal() * (root * root.transpose()) * size.asDiagonal();
  const MatrixXd R = FactorOf(cov);
  EXPECT_LT((size.cwiseInverse().asDiagonal() * (R * R.transpose() - cov) *
             size.cwiseInverse().asDiagonal())
                .norm(),
            1e-12 * (root * root.transpose()).norm());
  for (int reading = 0; reading < 60; ++reading) {
    const Index n = 2 + reading % 5;
    const MatrixXd wobble = Any(random, n, 3);
    const MatrixXd cov_noise = wobble * wobble.transpose() + 0.01 * MatrixXd::Identity(n, n);
    const MatrixXd F = Any(random, n, kCommon) * size.cwiseInverse().asDiagonal() * R;
    MatrixXd B = Any(random, n, kShifts);
    B.col(4) = B.col(0) - 2 * B.col(1);  // no shift of its own
    const VectorXd e = F * Any(random, kCommon, 1) + B.col(2) + wobble * Any(random, 3, 1);
    estimator.Add(cov_noise, F, B, e);
    dense.Add(cov_noise, F, B, e);
  }
  const ToolShiftEstimate found = estimator.Estimate();
  const Eigen::LDLT<MatrixXd> C(dense.C + dense.F * dense.F.transpose());
  // A shift in a combination that changes nothing is not told, whichever of them stands first.
  ASSERT_EQ(found.told, (std::vector<char>{0, 0, 1, 1, 0, 1}));
  EXPECT_EQ(found.rank, 5);
  const std::vector<Index> apart = {2, 3, 5}, enough = {0, 1, 2, 3, 5};
  const MatrixXd B = dense.B(Eigen::all, enough);
  const MatrixXd cov_x = (B.transpose() * C.solve(B)).inverse();
  const VectorXd x = cov_x * B.transpose() * C.solve(dense.e);
  const VectorXd beside = dense.e - B * x;
  // 240 residuals, covariances of condition 1e5: rounding of the dense form itself.
  constexpr double kRounding = 1e-9;
  EXPECT_EQ(found.dof, dense.e.size());
  EXPECT_NEAR(found.chi_square, dense.e.dot(C.solve(dense.e)), kRounding * found.chi_square);
  EXPECT_NEAR(found.left, beside.dot(C.solve(beside)), kRounding * found.left);
  EXPECT_LT((found.x(apart) - x.tail<3>()).norm(), kRounding * x.norm());
  EXPECT_LT((found.cov(apart, apart) - cov_x.bottomRightCorner<3, 3>()).norm(),
            kRounding * cov_x.norm());
  const VectorXd common = dense.F.transpose() * C.solve(beside);
  EXPECT_LT((found.common - common).norm(), kRounding * common.norm());
}

TEST(ToolShiftEstimate, HasNoCommonErrorsOrManyRows) {
  Random random(4);
  ToolShiftEstimator estimator(0, 1);
  double sum = 0, squares = 0;
  constexpr int kRows = 5000;
  for (int i = 0; i < kRows; ++i) {
    const double e = 3 + random.Normal();
    estimator.Add(MatrixXd::Identity(1, 1), MatrixXd(1, 0), MatrixXd::Ones(1, 1),
                  VectorXd::Constant(1, e));
    sum += e;
    squares += e * e;
  }
  const ToolShiftEstimate found = estimator.Estimate();
  EXPECT_NEAR(found.x[0], sum / kRows, 1e-12);
  EXPECT_NEAR(found.cov(0, 0), 1.0 / kRows, 1e-15);
  EXPECT_NEAR(found.left, squares - sum * sum / kRows, 1e-9 * squares);
}

}  // namespace
}  // namespace wellgyro::test
