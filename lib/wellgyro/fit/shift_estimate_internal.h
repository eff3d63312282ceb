#pragma once

#include <vector>

#include <Eigen/Core>

namespace wellgyro {

struct ToolShiftEstimate {
  /// By shift: it has no part in any combination of shifts that the residuals say nothing of.
  std::vector<char> told;
  Eigen::VectorXd x;  ///< of all shifts; of those not told the solution of least norm
  Eigen::MatrixXd cov;
  int rank = 0;            ///< combinations of shifts that the residuals tell
  Eigen::VectorXd common;  ///< mean of the common errors beside the shifts
  double chi_square = 0;   ///< of the residuals without shifts
  double left = 0;         ///< beside them
  int dof = 0;             ///< number of residuals
};

/// Generalised least squares of e = B x + F z + v: shifts x, common errors z of mean zero and unit
/// covariance, noise v independent from reading to reading. Cov e = F F' + blockdiag(cov v) is
/// never formed: z joins the unknowns with its own rows z = 0 (Lawson and Hanson, Solving Least
/// Squares Problems, 1974, ch. 27: sequential Householder triangularisation), so that time goes as
/// the number of readings and memory does not.
class ToolShiftEstimator {
 public:
  ToolShiftEstimator(Eigen::Index common, Eigen::Index shifts);

  /// The residuals of one reading; `cov_noise` of v, positive definite.
  void Add(const Eigen::MatrixXd& cov_noise, const Eigen::MatrixXd& F, const Eigen::MatrixXd& B,
           const Eigen::VectorXd& e);

  ToolShiftEstimate Estimate();

 private:
  void Reduce();

  Eigen::Index common_, shifts_;
  Eigen::MatrixXd rows_;     // triangle over what is not reduced yet, columns F, B, e
  Eigen::Index filled_ = 0;  // of rows_
  int dof_ = 0;
};

/// A factor R with R R' = cov, of a covariance that may be singular, its parameters of any sizes.
Eigen::MatrixXd FactorOf(const Eigen::MatrixXd& cov);

}  // namespace wellgyro
