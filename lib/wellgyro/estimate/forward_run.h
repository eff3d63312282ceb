#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "wellgyro/estimate/elimination.h"
#include "wellgyro/estimate/knot_rows.h"
#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/run_estimate.h"
#include "wellgyro/estimate/run_state.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// What is known of a run while it goes on: the factors of RunSolver, each made linear about what
/// was known then (the iterated extended Kalman filter, in information form). It goes on from where
/// the knots so far were solved together; memory and the cost of a knot stay as they are. Values
/// may be copied: a copy goes on alone.
class ForwardRun {
 public:
  /// Number of past knots that Step() reads, about a minute, for the usual change of the roll rate
  /// (RollWalkBy): a median of so many sizes tells a scale to 1.17 / sqrt(60) = 15 %, and decades
  /// are asked for.
  static constexpr std::size_t kLooksBack = 60;

  /// From the end of `knots`, the last of those that have been solved.
  ForwardRun(const RunState& solved, std::span<const RunKnot> knots);

  /// Takes the last of `knots`, the last of the run so far. What comes behind it, if that is known,
  /// says how the tool rolls from there on. False where the information is no longer positive:
  /// nothing changed then.
  bool Step(std::span<const RunKnot> knots, const Increment* next);

  /// At the end of the last knot taken.
  const RunState& state() const { return state_; }
  const Node& node() const { return state_.node(); }
  const Eigen::Matrix3d& CovPhi() const { return cov_phi_T_; }
  /// 1-sigma of the turn about the vertical [rad].
  double SigmaOfHeading() const;
  /// Makes the present node, of this number, a station, linked to the one before.
  LinkedErrors Mark(std::size_t node);

 private:
  void FreeRoll(double sigma);
  void Arrive(const Elimination& elimination, const Node& begin, const Node& end,
              const NodeVector& last_step);
  KnotPlace PlaceOf(std::span<const RunKnot> tail, const Node& end) const;

  RunState state_;
  Layout layout_;
  Eigen::Matrix3d cov_phi_T_;
};

}  // namespace wellgyro
