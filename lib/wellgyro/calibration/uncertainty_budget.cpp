#include "wellgyro/calibration/uncertainty_budget.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

using Eigen::Index;

// Place of a source among the columns, a new one at the end.
Index ColumnOf(const std::string& source, std::vector<std::string>& columns) {
  const auto found = std::find(columns.begin(), columns.end(), source);
  const Index place = found - columns.begin();
  if (found == columns.end()) columns.push_back(source);
  return place;
}

}  // namespace

void CovarianceParts::Add(std::string source, Eigen::MatrixXd more) {
  sources.push_back(std::move(source));
  cov.push_back(std::move(more));
}

CovarianceParts Propagated(const CovarianceParts& of_x, const Eigen::MatrixXd& J) {
  CovarianceParts of_y{of_x.sources, {}, of_x.variance_cov};
  for (const Eigen::MatrixXd& cov : of_x.cov) of_y.cov.push_back(J * cov * J.transpose());
  return of_y;
}

UncertaintyBudget BudgetOf(const CovarianceParts& parts) {
  UncertaintyBudget budget;
  if (parts.cov.empty()) return budget;
  const auto n_parts = static_cast<Index>(parts.cov.size());
  const Index n = parts.cov.front().rows(), n_found = parts.variance_cov.rows();
  Eigen::MatrixXd variances(n, n_parts);
  for (Index k = 0; k < n_parts; ++k) {
    variances.col(k) = parts.cov[static_cast<std::size_t>(k)].diagonal().cwiseMax(0.0);
  }
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(n, n_parts);
  for (Index k = 0; k < n_parts; ++k) {
    const Index at = ColumnOf(parts.sources[static_cast<std::size_t>(k)], budget.sources);
    squares.col(at) += variances.col(k);
    if (k < n_found) budget.n_type_a = static_cast<Index>(budget.sources.size());
  }
  budget.contributions = squares.leftCols(static_cast<Index>(budget.sources.size())).cwiseSqrt();
  budget.dof = Eigen::VectorXd::Constant(n, UncertaintyBudget::kManyDof);
  for (Index i = 0; i < n; ++i) {
    const Eigen::VectorXd found = variances.row(i).head(n_found);
    const double square = variances.row(i).sum(), of_square = found.dot(parts.variance_cov * found);
    if (of_square * UncertaintyBudget::kManyDof > 2 * square * square) {
      budget.dof[i] = 2 * square * square / of_square;
    }
  }
  return budget;
}

std::optional<double> CoverageFactor(double dof) {
  constexpr double kLeast = 2;
  if (!(dof >= kLeast)) return std::nullopt;
  return StudentLimit(NormalCdf(-2), dof);
}

}  // namespace wellgyro
