#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/knot_place.h"
#include "wellgyro/estimate/knot_terms.h"
#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/normal_block.h"
#include "wellgyro/estimate/roll_change.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// What a run has been found to be, beside its nodes and constants.
struct RunScales {
  double roll_walk = 0.1;   ///< of the roll rate [rad/s/sqrt(s)]
  double swing_walk = 0.1;  ///< of the swing, in phase and in quadrature [rad/s/sqrt(s)]
  /// Of each knot, how much the rate plainly changes there beyond its walk: starts and stops; empty
  /// where not yet known [rad/s].
  std::vector<double> roll_start;
  /// The same, as much as it may with the speed along the hole, and the share of it that it does.
  std::vector<double> speed_start;
  double speed_share = 1;
  bool follows_hole = false;  ///< the rate may change with the hole's bends too, see KnotPlace
  /// Of each knot, held while the run is brought to its end; empty: by the residuals.
  std::vector<std::array<double, 2>> roll_weight;
};

/// Whitened residuals of everything that a knot says of the nodes at its ends and of the border,
/// about their present values, added to `block`. R_IT(end) = R_IT(begin) Rz Exp(turn) Rz,
/// see Increment; w_IL turns L meanwhile.
class KnotRows {
 public:
  /// Both must outlive this object.
  KnotRows(const EstimateSetup& setup, const Layout& layout)
      : setup_(setup), layout_(layout), known_(KnownErrors(setup)) {}

  void Add(const RunKnot& knot, const KnotPlace& place, const RollChange& roll,
           const BorderVector& border, const Node& begin, const Node& end, NormalBlock& block);

 private:
  using Terms = KnotTerms;
  /// Those of kTurnSources, gyro shear, unequal mass unbalance and quadrature.
  using TurnErrors = Eigen::Matrix<double, 3, kTurnSources + 3>;
  using PhaseColumns = Eigen::Matrix<double, 3, 4>;

  // What a unit of the rate or of an error adds to the factor's rows: of no frame.
  void AddRate(const Terms& t, const Eigen::Vector3d& by_rate, NormalBlock& block);
  void AddError(const Terms& t, int source, const Eigen::Vector3d& by_error,
                const NormalBlock& block);

  void AddTurn(const Terms& t, NormalBlock& block);
  void AddGyroDrift(const Terms& t, int gyro, const Eigen::Vector3d& by_bias, NormalBlock& block);
  double GravityOffset(const Terms& t) const;
  void AddForceErrors(const Terms& t, double whiten, const Eigen::Vector3d& p_M,
                      const Eigen::Vector3d& by_skew_M, const Eigen::Matrix2d& beyond,
                      const PhaseColumns& by_phase, NormalBlock& block);
  void AddForce(const Terms& t, NormalBlock& block);
  void AddRoll(const Terms& t, const RollChange& roll, NormalBlock& block);
  double TurnNoise(double dt) const;
  void AddAxial(const Terms& t, NormalBlock& block);
  void AddDepth(const Terms& t, NormalBlock& block);
  void AddDrift(const Terms& t, NormalBlock& block);
  void AddRest(const Terms& t, NormalBlock& block);

  const EstimateSetup& setup_;
  const Layout& layout_;
  ErrorVector known_;
  Factor factor_;
};

}  // namespace wellgyro
