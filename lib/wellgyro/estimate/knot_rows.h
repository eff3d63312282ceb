#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/normal_block.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Where the path stands within a knot, held fixed while its rows are made linear.
struct KnotPlace {
  Site site;
  Eigen::Vector3d w_IL_L = Eigen::Vector3d::Zero();  ///< Earth's rate and transport [rad/s]
  Eigen::Vector3d dw_by_latitude = Eigen::Vector3d::Zero();
  /// Acceleration of the path but for that along it, less gravity: R_LT' of it is the force.
  Eigen::Vector3d force_L = Eigen::Vector3d::Zero();
  double since_start = 0;  ///< middle of the knot [s]
  double depth = 0;        ///< vertical, below node 0 [m]
};

/// What a run has been found to be, beside its nodes and constants.
struct RunScales {
  double roll_walk = 0.1;  ///< of the roll rate [rad/s/sqrt(s)]
  /// Of each knot, how much the rate plainly changes there beyond its walk: starts and stops; empty
  /// where not yet known [rad/s].
  std::vector<double> roll_start;
};

/// Whitened residuals of everything that a knot says of the nodes at its ends and of the border,
/// about their present values, added to `block`. R_IT(end) = R_IT(begin) Rz Exp(turn) Rz,
/// see Increment; w_IL turns L meanwhile.
class KnotRows {
 public:
  /// Both must outlive this object.
  KnotRows(const EstimateSetup& setup, const Layout& layout) : setup_(setup), layout_(layout) {}

  /// `walk`: of the roll rate over this knot, 1-sigma [rad/s].
  void Add(const RunKnot& knot, const KnotPlace& place, double walk, const BorderVector& border,
           const Node& begin, const Node& end, NormalBlock& block);

 private:
  struct Terms;
  Terms TermsOf(const RunKnot& knot, const KnotPlace& place, const BorderVector& border,
                const Node& begin, const Node& end) const;
  void AddTurn(const Terms& t, NormalBlock& block);
  void AddForce(const Terms& t, NormalBlock& block);
  void AddRoll(const Terms& t, double walk, NormalBlock& block);
  void AddAxial(const Terms& t, NormalBlock& block);
  void AddDepth(const Terms& t, NormalBlock& block);
  void AddDrift(const Terms& t, NormalBlock& block);
  void AddRest(const Terms& t, NormalBlock& block);
  double SourceAt(const BorderVector& border, int source) const {
    const int at = layout_.source[static_cast<std::size_t>(source)];
    return at == kAbsent ? 0 : border[at];
  }

  const EstimateSetup& setup_;
  const Layout& layout_;
  Factor factor_;
};

}  // namespace wellgyro
