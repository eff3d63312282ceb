#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/survey/wells/merge.h"

namespace wellgyro {

/// One leg, by its place in the list, for each stretch of a hole.
using LegOrder = std::vector<std::size_t>;

/// A part of the hole between two depths at which a leg begins or ends.
struct LegStretch {
  double begin = 0, end = 0;            ///< stations of (begin, end] [m]
  std::vector<std::size_t> candidates;  ///< legs that reach all through it
};

/// The survey that an order makes.
struct AssembledLegs {
  std::vector<SurveyPoint> stations;  ///< depth increasing, TVD not filled
  std::vector<ToolLeg> legs;          ///< stretches of one leg that follow each other are one
  std::vector<std::size_t> leg_of;    ///< of each tool leg
};

/// The stretches that legs part a hole into, and what an order of legs over them comes to.
class LegOrders {
 public:
  /// All that are referred to must outlive this object. Throws std::invalid_argument as Merge() for
  /// legs that leave a gap or no stretch at all.
  LegOrders(std::span<const MergeLeg> legs, const Eigen::Vector3d& start_W,
            const Eigen::Matrix3d& cov_tie_in_W, const Surroundings& surroundings,
            const MergePolicy& policy);

  const std::vector<LegStretch>& stretches() const { return stretches_; }
  /// The stations of each stretch from its leg; at a break those of the leg above. An order may end
  /// before the last stretch.
  AssembledLegs Assemble(const LegOrder& order) const;
  /// Positions by minimum curvature from the start that was given.
  SurveyedWell WellOf(const AssembledLegs& assembled) const;
  /// Carried through the ties, from the tie-in's covariance on.
  PositionUncertainty Errors(const SurveyedWell& well, const AssembledLegs& assembled) const;
  /// What the policy makes small [m]: at the deepest station of the order, or where the policy says
  /// if it reaches there; infinite where a model ends before.
  double MeasureOf(const LegOrder& order) const;

 private:
  std::span<const MergeLeg> legs_;
  Eigen::Vector3d start_W_;
  Eigen::Matrix3d cov_tie_in_W_;
  const Surroundings& surroundings_;
  const MergePolicy& policy_;
  std::vector<LegStretch> stretches_;
};

}  // namespace wellgyro
