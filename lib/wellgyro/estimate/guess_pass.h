#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Places the nodes of a run one after the other: the gyros carry the axis, gravity turns the tool
/// about it. A first guess, from which a RunSolver begins.
class GuessPass {
 public:
  /// `knots` and HiddenRoll() of them must outlive this object; at least one knot.
  GuessPass(const EstimateSetup& setup, std::span<const RunKnot> knots,
            std::span<const double> hidden_roll);

  /// The attitude of node 0.
  void Begin(const Eigen::Matrix3d& R_LT) { nodes_[0].R_LT = R_LT; }
  /// Of each knot, where the roll inside it was not seen and is known to be more [rad].
  std::vector<double>& extra_roll() { return extra_roll_; }
  /// The nodes after `begin`, which stands, up to `end`.
  void Run(std::size_t begin, std::size_t end);
  const std::vector<Node>& nodes() const& { return nodes_; }
  std::vector<Node> nodes() && { return std::move(nodes_); }

 private:
  double latitude_;
  std::span<const RunKnot> knots_;
  std::span<const double> hidden_roll_;
  std::vector<double> extra_roll_;
  std::vector<Node> nodes_;
};

}  // namespace wellgyro
