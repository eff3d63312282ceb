#pragma once

#include <span>

#include <Eigen/Core>

namespace wellgyro {

/// Most terms a fit can have.
inline constexpr int kFitTermsMax = 6;
using TermVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kFitTermsMax, 1>;
using TermMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kFitTermsMax, kFitTermsMax>;

/// The x >= 0 that minimises x' gram x / 2 - rhs' x, gram positive definite (Bro and de Jong, J.
/// Chemometrics 11, 1997, after Lawson and Hanson).
TermVector NonnegativeLeastSquares(const TermMatrix& gram, const TermVector& rhs);

/// Sample variances fitted by a sum of terms with weights that are not negative.
struct WeightFit {
  TermVector weight;    // of each column
  double deviance = 0;  // sum of edf (s/mu - 1 - ln(s/mu))
};

/// Variances of chi-square scatter and the columns that explain them.
struct VarianceProblem {
  Eigen::MatrixXd columns;
  Eigen::VectorXd edf;     ///< > 0
  Eigen::VectorXd offset;  ///< part of every model, at weight 1
};

/// Minimises the deviance of `s` > 0 over weights >= 0 of the columns, mu = offset + columns *
/// weight, by reweighted least squares: the weights go by the model's variances, since weights that
/// go by the measured ones favour the low. Columns whose bit in `used` is not set stay 0. At least
/// one used column, or the offset, must be positive everywhere.
WeightFit FitVariances(const VarianceProblem& problem, const Eigen::VectorXd& s, unsigned used);

}  // namespace wellgyro
