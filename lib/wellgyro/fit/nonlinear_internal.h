#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <ceres/dynamic_autodiff_cost_function.h>

#include "wellgyro/base/result.h"
#include "wellgyro/fit/least_squares_internal.h"

namespace wellgyro {

/// A least-squares problem in one vector of parameters, of residuals that are not linear in it.
/// Solved by Ceres, then handed to the linear solver at its solution, for one more step to the last
/// digits and the statistics.
class NonlinearProblem {
 public:
  NonlinearProblem(std::vector<std::string> parameters, Eigen::VectorXd start)
      : parameters_(std::move(parameters)), start_(std::move(start)) {}

  bool sigma_given = false;   ///< residuals are in units of known sigmas
  bool robust = true;         ///< look for outliers, all residuals of a line together
  double least_scale = 1e-9;  ///< whitened; what lies within six of it is no outlier

  void Start(Eigen::VectorXd start) { start_ = std::move(start); }
  /// Holds a parameter between bounds.
  void Bound(int parameter, double low, double high) { bounds_.push_back({parameter, low, high}); }

  /// `of` gives the residuals `rows.size()`, whitened: template <class T>
  /// bool operator()(const T* const* x, T* residuals) const, with x[0] the parameters.
  template <class F>
  void Add(std::vector<FitRow> rows, F of) {
    const int n_parameters = static_cast<int>(parameters_.size());
    const int n = static_cast<int>(rows.size());
    blocks_.push_back({std::move(rows), [of, n, n_parameters] {
                         auto cost =
                             std::make_unique<ceres::DynamicAutoDiffCostFunction<F, 6>>(new F(of));
                         cost->AddParameterBlock(n_parameters);
                         cost->SetNumResiduals(n);
                         return std::unique_ptr<ceres::CostFunction>(std::move(cost));
                       }});
  }

  struct Solution {
    Eigen::VectorXd x;
    LinearProblem linear;  ///< about x, outliers left out
    double cost = 0;       ///< half the sum of squares
    std::vector<int> outlier_lines;
  };
  /// The Fault when the iteration does not converge.
  Result<Solution> Solve() const;

 private:
  struct Block {
    std::vector<FitRow> rows;
    std::function<std::unique_ptr<ceres::CostFunction>()> cost;
  };
  struct BoundOf {
    int parameter;
    double low, high;
  };
  struct Minimum;
  Minimum Minimise(const Eigen::VectorXd& start, double cauchy,
                   const std::vector<int>& without) const;
  LinearProblem Linearise(const Eigen::VectorXd& x, const std::vector<int>& without) const;
  double Scale(const Eigen::VectorXd& x) const;
  std::vector<int> Outliers(const Eigen::VectorXd& x, double scale) const;
  Eigen::VectorXd Residuals(const Eigen::VectorXd& x) const;

  std::vector<std::string> parameters_;
  Eigen::VectorXd start_;
  std::vector<Block> blocks_;
  std::vector<BoundOf> bounds_;
};

/// The same of a problem that is not linear; or why it has no solution.
Result<FitReport> WholeReport(const BenchTable& data,
                              const Result<NonlinearProblem::Solution>& solution,
                              std::string_view advice);

}  // namespace wellgyro
