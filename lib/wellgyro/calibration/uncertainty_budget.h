#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Standard uncertainties of quantities source by source, u^2 = sum_j u_j^2 for sources that are
/// independent of each other (JCGM 100:2008, 5.1.2).
struct UncertaintyBudget {
  std::vector<std::string> sources;  ///< columns
  Eigen::Index n_type_a = 0;         ///< the first columns are of type A, by the readings' scatter
  Eigen::MatrixXd contributions;     ///< a row a quantity, in its unit
  /// Effective degrees of freedom of u, by quantity, up to kManyDof.
  Eigen::VectorXd dof;

  static constexpr double kManyDof = 1e9;  ///< as good as infinite: of type B alone
};

/// A covariance as the sum of what independent sources contribute to it.
struct CovarianceParts {
  /// Several of one name are one source of a budget.
  std::vector<std::string> sources;
  std::vector<Eigen::MatrixXd> cov;
  /// The first are of type A: variance components v_k that the readings gave, their covariance over
  /// v_k v_l. One found alone has 2 / dof.
  Eigen::MatrixXd variance_cov;

  /// A source of type B.
  WELLGYRO_EXPORT void Add(std::string source, Eigen::MatrixXd more);
};

/// Of y = J x.
WELLGYRO_EXPORT CovarianceParts Propagated(const CovarianceParts& of_x, const Eigen::MatrixXd& J);

/// Of each quantity. Effective degrees of freedom by Welch and Satterthwaite (JCGM 100:2008, G.4),
/// 2 u^4 / var(u^2), where variances that the readings gave together are correlated.
WELLGYRO_EXPORT UncertaintyBudget BudgetOf(const CovarianceParts& parts);

/// The k by which u covers 95.45 % of a Student's distribution: 2 where dof is infinite; none below
/// two degrees of freedom, which hardly bound an error.
WELLGYRO_EXPORT std::optional<double> CoverageFactor(double dof);

}  // namespace wellgyro
