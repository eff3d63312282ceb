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

/// What one of a channel's unit in one of its readings adds to the rows that a solution used.
struct ReadingUnit {
  Eigen::Index first = 0;  ///< of those rows
  Eigen::VectorXd z;       ///< whitened
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
  /// The same of columns that are whitened already, over the rows that the solution used.
  std::vector<AddedTerm> TestWhitened(const Eigen::MatrixXd& z, double probability) const;
  /// Of these readings in the order of time the first one of the likeliest step: by its place among
  /// them, with kBesideStep and more on either side. 0: there is none.
  std::size_t LikeliestStep(const std::vector<ReadingUnit>& readings) const;

  /// Of the reading that a row of the problem, which the solution used, is labelled with.
  ReadingUnit UnitOf(std::size_t row) const;
  /// Of a reading that adds `z` to the rows of the problem from `row` on.
  ReadingUnit UnitAt(Eigen::Index row, const Eigen::VectorXd& z) const {
    return {place_[static_cast<std::size_t>(row)], z};
  }
  Eigen::Index used() const { return A_.rows(); }  ///< rows that the solution used

 private:
  double Variance() const;
  /// What columns of the data's unit by row of the problem are in the rows used.
  Eigen::MatrixXd WhitenedColumns(const Eigen::MatrixXd& Z) const;

  const LinearProblem& problem_;
  const LinearSolution& solution_;
  std::vector<Eigen::Index> used_;   ///< rows of the problem that the solution used
  std::vector<Eigen::Index> place_;  ///< by row of the problem, in those
  Eigen::MatrixXd A_;                ///< of those, whitened
};

}  // namespace wellgyro
