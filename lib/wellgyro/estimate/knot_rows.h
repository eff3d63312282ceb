#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/normal_block.h"
#include "wellgyro/estimate/roll_change.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Where the path stands within a knot, held fixed while its rows are made linear.
struct KnotPlace {
  Site site;
  Eigen::Vector3d w_IL_L = Eigen::Vector3d::Zero();  ///< Earth's rate and transport [rad/s]
  Eigen::Vector3d dw_by_latitude = Eigen::Vector3d::Zero();
  /// Acceleration of the path across itself, with Coriolis' [m/s^2]. Its derivative by a turn of
  /// the node about the vertical is that of a vector fixed in the tool: the path is drawn from the
  /// node's own azimuth, and so has no information on it.
  Eigen::Vector3d acceleration_L = Eigen::Vector3d::Zero();
  /// What the Earth's rate about the axis changes by, from this knot to the next [rad/s]: so does
  /// the inertial roll rate of a tool that does not turn in its hole.
  double axial_change = 0;
  /// Of the inertial roll rate of a tool that keeps its toolface in a hole that bends: that rate is
  /// A' cos I [rad/s/sqrt(s)].
  double roll_walk = 0;
  /// By which the roll leads psi and an even turn beside it, in the mean of the knot, where gravity
  /// does not show it [rad].
  double roll_bow = 0;
  double since_start = 0;  ///< middle of the knot [s]
  double depth = 0;        ///< vertical, below node 0 [m]
};

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
  KnotRows(const EstimateSetup& setup, const Layout& layout) : setup_(setup), layout_(layout) {
    known_[kMisalignmentX] = setup.errors.gyro_misalignment_x;
    known_[kMisalignmentY] = setup.errors.gyro_misalignment_y;
  }

  void Add(const RunKnot& knot, const KnotPlace& place, const RollChange& roll,
           const BorderVector& border, const Node& begin, const Node& end, NormalBlock& block);

 private:
  struct Terms;
  /// Those of kTurnSources, gyro shear, unequal mass unbalance and quadrature.
  using TurnErrors = Eigen::Matrix<double, 3, kTurnSources + 3>;
  using PhaseColumns = Eigen::Matrix<double, 3, 4>;
  static void TakeWobble(Terms& t);
  static void CorrectTurn(Terms& t);
  Terms TermsOf(const RunKnot& knot, const KnotPlace& place, const BorderVector& border,
                const Node& begin, const Node& end) const;
  void AddRate(const Terms& t, const Eigen::Vector3d& by_rate, NormalBlock& block);
  void AddError(const Terms& t, int source, const Eigen::Vector3d& by_error,
                const NormalBlock& block);
  ErrorVector ErrorsAt(const BorderVector& border, double warmth) const;
  void AddTurn(const Terms& t, NormalBlock& block);
  void AddGyroDrift(const Terms& t, const TurnErrors& by_error, NormalBlock& block);
  Eigen::Vector3d ForceOf(const Terms& t, const Eigen::Vector3d& by_skew) const;
  double GravityOffset(const Terms& t) const;
  void AddForceErrors(const Terms& t, double whiten, const Eigen::Vector3d& p,
                      const Eigen::Vector3d& by_skew, const Eigen::Matrix2d& beyond,
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
  ErrorVector known_ = ErrorVector::Zero();
  Factor factor_;
};

}  // namespace wellgyro
