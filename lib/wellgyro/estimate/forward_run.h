#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "wellgyro/estimate/elimination.h"
#include "wellgyro/estimate/knot_rows.h"
#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/run_estimate.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// What is known of a run while it goes on: the factors of RunSolver, each made linear about what
/// was known then (the iterated extended Kalman filter, in information form). It goes on from where
/// the knots so far were solved together; memory and the cost of a knot stay as they are. Values
/// may be copied: a copy goes on alone.
class ForwardRun {
 public:
  /// From the end of `solved`, which has solved `knots`.
  ForwardRun(const RunEstimate& solved, std::span<const RunKnot> knots);

  /// Takes the last of all `knots` of the run so far. What comes behind it, if that is known, says
  /// how the tool rolls from there on. False where the information is no longer positive: nothing
  /// changed then.
  bool Step(std::span<const RunKnot> knots, const Increment* next);

  /// At the end of the last knot taken.
  const Node& node() const { return nodes_.back(); }
  Eigen::Matrix3d CovPhi() const { return cov_.topLeftCorner<3, 3>(); }
  /// 1-sigma of the turn about the vertical [rad].
  double SigmaOfHeading() const;
  /// Makes the present node, of this number, a station, linked to the one before.
  LinkedErrors Mark(std::size_t node);

 private:
  static constexpr std::size_t kTail = 4;  ///< nodes: those between which the hole's bend is read

  EdgeVector Away(const Node& to, const BorderVector& border) const;
  KnotPlace PlaceOf(std::span<const RunKnot> tail, const Node& end) const;

  EstimateSetup setup_;
  Layout layout_;
  std::array<Node, kTail> nodes_;  ///< the newest last
  BorderVector border_;
  EdgeMatrix information_, cov_;                 ///< of [newest node; border]
  Eigen::MatrixXd link_;                         ///< E[x_station (node; border)'] = link_ cov_
  Eigen::Vector3d p_ = Eigen::Vector3d::Zero();  ///< from node 0 [m]
  double seconds_ = 0;
};

}  // namespace wellgyro
