#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Eigenvalues>
#include <fmt/core.h>
#include <gtest/gtest.h>

#include "wellgyro/calibration/fit_report.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro::test {

/// Errors of many fits against their stated covariances.
class ErrorFamily {
 public:
  /// Parameters that can only be what they are (sigma 0) and dependent ones do not count.
  void Add(const FitReport& report, const Eigen::VectorXd& truth) {
    ASSERT_EQ(report.values.size(), truth.size());
    ASSERT_GT(report.cov.size(), 0);
    const Eigen::VectorXd sigma = report.cov.diagonal().cwiseMax(0).cwiseSqrt();
    std::vector<Eigen::Index> free;
    Eigen::VectorXd error(truth.size());
    for (Eigen::Index i = 0; i < truth.size(); ++i) {
      if (!(sigma[i] > 0)) continue;
      error[static_cast<Eigen::Index>(free.size())] = (report.values[i] - truth[i]) / sigma[i];
      free.push_back(i);
    }
    const auto n = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd correlation(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        const Eigen::Index a = free[static_cast<std::size_t>(i)];
        const Eigen::Index b = free[static_cast<std::size_t>(j)];
        correlation(i, j) = report.cov(a, b) / (sigma[a] * sigma[b]);
      }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(correlation);
    const Eigen::VectorXd along = solver.eigenvectors().transpose() * error.head(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      if (solver.eigenvalues()[i] < 1e-7 * static_cast<double>(n)) continue;
      sum_ += along[i] * along[i] / solver.eigenvalues()[i];
      ++dof_;
    }
    worst_ = std::max(worst_, error.head(n).cwiseAbs().maxCoeff());
    chi_ += report.chi_square;
    chi_dof_ += report.dof;
    ++fits_;
  }

  /// Inside the band that one family of `families` leaves once in a hundred together; no parameter
  /// beyond five sigmas; the residuals' chi-square too.
  void Expect(const std::string& name, int families) const {
    const double each = 0.01 / families / 2;
    fmt::print("  {:<22} {} sets: errors {:.4f} of {}, residuals {:.4f}, worst {:.2f} sigma\n",
               name, fits_, sum_ / dof_, dof_, chi_dof_ > 0 ? chi_ / chi_dof_ : 1, worst_);
    EXPECT_GT(sum_, ChiSquareQuantile(each, dof_)) << name;
    EXPECT_LT(sum_, ChiSquareQuantile(1 - each, dof_)) << name;
    EXPECT_LT(worst_, 5) << name;
    EXPECT_GT(worst_, 1) << name;
    if (chi_dof_ == 0) return;
    EXPECT_GT(chi_, ChiSquareQuantile(each, chi_dof_)) << name;
    EXPECT_LT(chi_, ChiSquareQuantile(1 - each, chi_dof_)) << name;
  }

 private:
  double sum_ = 0, worst_ = 0, chi_ = 0;
  int dof_ = 0, chi_dof_ = 0, fits_ = 0;
};

}  // namespace wellgyro::test
