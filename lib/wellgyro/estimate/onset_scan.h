#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/linear_run.h"

namespace wellgyro {

/// Of a cause with one column c.
struct Score {
  double score = 0;                                   ///< s = c'P r
  double information = 0;                             ///< M = c'P c
  Eigen::Vector3d shift_W = Eigen::Vector3d::Zero();  ///< of the end, of a unit of the cause [m]

  double size() const { return information > 0 ? score / information : 0; }
};

/// Where the end of the run, a linear function of the nodes, goes with each row: J N^-1 b.
class EndInfluence {
 public:
  /// `end_by_phi_W`: of every node, derivative of the end by its phi [m].
  EndInfluence(const LinearRun& run, std::span<const Eigen::Matrix3d> end_by_phi_W);

  /// Of each row of the factor, how the end moves when the row's r grows by one, sign turned.
  Eigen::Matrix3d Of(std::size_t knot, const Factor& f) const;
  /// The same of J'c, `x` over [node | next node | border].
  Eigen::Vector3d Of(std::size_t knot, const NormalBlock::Vector& x) const;
  /// The same of a unit of the border's unknown `i` in its prior.
  Eigen::Vector3d OfPrior(int i) const {
    return solved_.border.transpose() * layout_.information.col(i);
  }

 private:
  const Layout& layout_;
  LinearRun::Columns solved_;
};

/// Steps of unknowns of the border at every node, by one pass forward and one backward.
///
/// A step of unknown u from node t on has for column c minus u's columns of the knots after t. P
/// does not see J v (P J = 0): c may as well be u's prior row and its columns of the knots before
/// t, which a forward pass has summed when it comes to t.
class OnsetScan {
 public:
  /// `unknowns`: columns of the border.
  OnsetScan(const LinearRun& run, std::vector<int> unknowns);

  /// To be called of knots 0, 1, ... in turn with LinearRun::BlockOf() them.
  void Forward(std::size_t knot, const NormalBlock& rows, const EndInfluence& influence);
  /// With the covariance of [node; border], of every node, in any order after the last knot.
  void Backward(std::size_t node, const EdgeMatrix& covariance);

  /// Of unknown `i` a step from node `t` on. At node 0 it is a constant, at the last one nothing.
  const Score& At(std::size_t i, std::size_t t) const { return scores_[t][i]; }
  std::size_t size() const { return unknowns_.size(); }

 private:
  void Record();

  const LinearRun& run_;
  std::vector<int> unknowns_;
  Eigen::MatrixXd edge_;  ///< what is yet to be eliminated of J'c, one cause a column
  Eigen::MatrixXd work_;
  std::vector<Score> now_;
  std::vector<Eigen::MatrixXd> edges_;
  std::vector<std::vector<Score>> scores_;  ///< of each node, each unknown
};

/// The part of a factor's columns that is of the border's unknown `i`; zero where it has none.
Eigen::Vector3d ColumnOf(const Factor& f, const Layout& layout, int i);

}  // namespace wellgyro
