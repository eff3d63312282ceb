#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/fit/least_squares_internal.h"

namespace wellgyro {

/// A bad reading or two at an end of a table are no step.
inline constexpr std::size_t kBesideStep = 3;

/// A term that a model lacks, as its residuals tell it.
struct AddedTerm {
  double coefficient = 0;  ///< by least squares with it; 0 where the model holds the term already
  double sigma = 0;
  double sigmas = 0, limit = 0;  ///< |coefficient| over sigma; what chance reaches
  std::string moved;             ///< the parameter that it would move most
  double moved_sigmas = 0;
};

/// Terms beyond a linear model, tested at its solution (added variables, score test of Rao).
///
/// Where sigmas are given, a scatter of the residuals beyond them counts in place of them: a bad
/// reading is then not taken for a term.
class AddedTerms {
 public:
  /// Both must outlive this object. Nothing is found where the covariance is unknown.
  AddedTerms(const LinearProblem& problem, const LinearSolution& solution);

  /// All columns of `Z` together: what one of the term adds to each row of the problem [the data's
  /// unit]. `probability` of a false alarm of each, of one side.
  std::vector<AddedTerm> Test(const Eigen::MatrixXd& Z, double probability) const;
  /// Of these rows of the problem, used and in the order of time, the first one of the likeliest
  /// step: by its place in `rows`, with kBesideStep rows and more on either side. 0: there is none.
  std::size_t LikeliestStep(const std::vector<Eigen::Index>& rows) const;

 private:
  double Variance() const;
  /// What one of the data's unit in the reading of this row of the problem adds to those used.
  struct Whitened {
    Eigen::Index first = 0;  ///< of the rows used
    Eigen::VectorXd z;
  };
  Whitened UnitOf(std::size_t row) const;

  const LinearProblem& problem_;
  const LinearSolution& solution_;
  std::vector<Eigen::Index> used_;   ///< rows of the problem that the solution used
  std::vector<Eigen::Index> place_;  ///< by row of the problem, in those
  Eigen::MatrixXd A_;                ///< of those, whitened
};

}  // namespace wellgyro
