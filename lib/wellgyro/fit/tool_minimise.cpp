#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include <ceres/ceres.h>

#include "wellgyro/fit/tool_minimise_internal.h"

namespace wellgyro {
namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// A row's readings against the model, whitened.
class RowCost : public ceres::CostFunction {
 public:
  RowCost(const ToolModel& model, const ToolRow& row, Eigen::MatrixXd whitener)
      : model_(model), row_(row), whitener_(std::move(whitener)) {
    set_num_residuals(static_cast<int>(row.channels.size()));
    mutable_parameter_block_sizes()->push_back(model.size());
  }
  bool Evaluate(const double* const* p, double* r, double** jacobians) const override {
    const auto n = static_cast<Eigen::Index>(row_.channels.size());
    const auto x = Eigen::Map<const Eigen::VectorXd>(p[0], model_.size());
    const ToolModel::Prediction at = model_.At(row_, x);
    Eigen::Map<Eigen::VectorXd>(r, n) = whitener_ * (at.v - row_.v);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<RowMajorMatrix>(jacobians[0], n, model_.size()) = whitener_ * at.J;
    }
    return true;
  }

 private:
  const ToolModel& model_;
  const ToolRow& row_;
  Eigen::MatrixXd whitener_;
};

// What was known before: A (x - x0), rows of unit variance.
class PriorCost : public ceres::CostFunction {
 public:
  PriorCost(RowMajorMatrix A, Eigen::VectorXd x0) : A_(std::move(A)), x0_(std::move(x0)) {
    set_num_residuals(static_cast<int>(A_.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(A_.cols()));
  }
  bool Evaluate(const double* const* p, double* r, double** jacobians) const override {
    const auto x = Eigen::Map<const Eigen::VectorXd>(p[0], A_.cols());
    Eigen::Map<Eigen::VectorXd>(r, A_.rows()) = A_ * (x - x0_);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<RowMajorMatrix>(jacobians[0], A_.rows(), A_.cols()) = A_;
    }
    return true;
  }

 private:
  RowMajorMatrix A_;
  Eigen::VectorXd x0_;
};

}  // namespace

ToolPrior PriorOfTool(const ToolModel& model) {
  std::vector<std::pair<int, double>> known;
  for (int k = 0; k < model.n_terms(); ++k) {
    const double sigma = model.terms()[static_cast<std::size_t>(k)].prior_sigma;
    if (sigma > 0) known.emplace_back(k, sigma);
  }
  int at = model.n_terms();
  for (const BenchNuisance& nuisance : model.nuisances()) {
    known.emplace_back(at++, nuisance.prior_sigma);
  }
  const auto n = static_cast<Eigen::Index>(known.size());
  ToolPrior prior{RowMajorMatrix::Zero(n, model.size()), Eigen::VectorXd::Zero(model.size())};
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [parameter, sigma] = known[static_cast<std::size_t>(i)];
    prior.A(i, parameter) = 1 / sigma;
  }
  return prior;
}

bool MinimiseTool(const ToolModel& model, const std::vector<WhitenedRow>& rows, bool robust,
                  Eigen::VectorXd& x) {
  ceres::Problem problem;
  problem.AddParameterBlock(x.data(), model.size());
  for (const auto& [row, whitener] : rows) {
    auto cost = std::make_unique<RowCost>(model, *row, whitener);
    const double size = std::sqrt(static_cast<double>(row->channels.size()));
    problem.AddResidualBlock(cost.release(), robust ? new ceres::CauchyLoss(2 * size) : nullptr,
                             x.data());
  }
  const ToolPrior prior = PriorOfTool(model);
  problem.AddResidualBlock(new PriorCost(prior.A, prior.x0), nullptr, x.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-12;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.minimizer_progress_to_stdout = false;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.IsSolutionUsable() && x.allFinite();
}

}  // namespace wellgyro
