#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/normal_block.h"

namespace wellgyro {

/// Bordered block-tridiagonal normal equations, eliminated node by node in the order of time.
///
/// Eliminating node k leaves what it knew of its successor and the border, and the conditional
///   x_k = gain [x_k+1; border] + offset + e,   cov(e) = (L L')^-1,
/// e independent of all that comes later: forward the filter, back substitution the smoother
/// (Rauch, Tung and Striebel in information form). Cost and memory are proportional to the nodes.
/// Cholesky is invariant to the scale of the unknowns, so none is applied; what the information of
/// stiff neighbours rounds off, 1e-16 of it a node, stays below 1e-2 rad^-2 of azimuth in 16 h.
class Elimination {
 public:
  using Columns = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

  explicit Elimination(const Layout& layout) : layout_(&layout) {}

  /// Begins at a first node whose information is `information` of [node, border] (lower triangle)
  /// with gradient `gradient`.
  void Start(std::size_t nodes, const EdgeMatrix& information, const EdgeVector& gradient);
  /// Adds what ties node k to k + 1 and eliminates k. False where the information is not positive:
  /// something is unobserved, or not finite.
  bool Step(const NormalBlock& block);
  /// Of the newest node and the border (lower triangle).
  Columns edge_information() const {
    return {information_.data(), gradient_.size(), gradient_.size(),
            Eigen::OuterStride<>(edge_stride_)};
  }

  /// Solves for the steps of all unknowns. False as Step().
  bool Solve(std::vector<NodeVector>& nodes, BorderVector& border);
  /// Covariance of [last node; border], after Solve().
  EdgeMatrix LastCovariance() const;
  /// Of its first three unknowns, at a tenth of the cost.
  Eigen::Matrix3d LastCovarianceOfPhi() const;

  /// x_k = gain [x_k+1; border] + ...
  BehindMatrix Gain(std::size_t k) const;
  /// cov(e) of node k.
  NodeMatrix Remainder(std::size_t k) const;
  /// From the covariance of [node k + 1; border] to that of [node k; border], with Gain(k);
  /// `with_next` becomes E[x_k (x_k+1; border)'].
  EdgeMatrix CovarianceBefore(std::size_t k, const BehindMatrix& gain, const EdgeMatrix& next,
                              BehindMatrix& with_next) const {
    return CovarianceThrough(gain, Remainder(k), next, with_next);
  }
  /// The same over any number of nodes, whose conditionals together are
  ///   x = gain [x_next; border] + e,   cov(e) = `remainder`.
  static EdgeMatrix CovarianceThrough(const BehindMatrix& gain, const NodeMatrix& remainder,
                                      const EdgeMatrix& next, BehindMatrix& with_next);
  /// Solves for other right-hand sides, one a column of `x` over [node k | next node | border],
  /// from node to node: Eliminate() divides node k by L and takes from what follows what it told;
  /// Substitute(), where what follows is solved, ends node k.
  void Eliminate(std::size_t k, Eigen::Ref<Eigen::MatrixXd> x) const;
  void Substitute(std::size_t k, Eigen::Ref<Eigen::MatrixXd> x) const;
  /// ln det of the information of all unknowns, after Solve().
  double log_determinant() const { return log_determinant_; }
  /// Newton's decrement squared, g' H^-1 g, after Solve(): how far the step is in sigmas, all
  /// unknowns together. Infinite where it did not solve.
  double decrement() const { return solved_ ? decrement_ : HUGE_VAL; }

 private:
  /// Of node k, in its n columns: L (lower) over (L^-1 times the information with [next node;
  /// border])'. Behind them L^-1 times the gradient.
  Columns PanelOf(std::size_t k) const {
    return {conditionals_.data() + k * ConditionalSize(), rows_, layout_->node,
            Eigen::OuterStride<>(stride_)};
  }
  std::size_t ConditionalSize() const {
    return static_cast<std::size_t>(layout_->node * stride_ + ByFours(layout_->node));
  }
  void Keep(const double* gradient);

  static constexpr Eigen::Index kEdgeMost = kNodeMax + kBorderMax;

  const Layout* layout_;
  std::vector<double> conditionals_;  ///< of each node the panel and the gradient
  std::size_t eliminated_ = 0;
  Eigen::Index rows_ = 0;                      ///< of [node | next node | border]
  Eigen::Index stride_ = 0, edge_stride_ = 0;  ///< of columns over these and over [node; border]
  /// Of [newest node; border], lower.
  alignas(
      32) std::array<double, static_cast<std::size_t>(ByFours(kEdgeMost) * kEdgeMost)> information_;
  EdgeVector gradient_;
  EdgeMatrix last_;  ///< its Cholesky factor
  double log_determinant_ = 0, decrement_ = 0;
  bool solved_ = false;
};

/// Of [node; border] before a knot, of the same behind it, and E[node (next node; border)'], that
/// of [node | next node | border].
BlockMatrix JointCovariance(const EdgeMatrix& begin, const BehindMatrix& begin_with_end,
                            const EdgeMatrix& end);

}  // namespace wellgyro
