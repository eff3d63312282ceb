#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/estimate/diagnosis.h"
#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/north_closure.h"
#include "wellgyro/estimate/run_solver.h"
#include "wellgyro/estimate/run_state.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/estimate/start.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Errors of a run at one of its nodes that stay linked to those of others: attitude, drift, and
/// the tool's constants. Those of the marked nodes form a chain in time.
struct LinkedErrors {
  std::size_t node = 0;
  Eigen::MatrixXd cov;                ///< E[x x'], phi of the node first
  Eigen::MatrixXd cov_with_previous;  ///< E[x_previous x'] of the marked node before; empty: none
};

/// A run as all its knots together tell it.
struct RunEstimate {
  bool solved = false;  ///< false: what follows means nothing
  SolveReport report;   ///< of the start that fits best, with the noise as stated
  double gyro_noise = 1, accel_noise = 1;  ///< found, over stated, where residuals are too large
  /// The azimuth is not decided: another solution, 20 deg away somewhere, comes within 9 in
  /// evidence, or no node's heading is known within 20 deg. A nearer one counts in the covariance.
  bool ambiguous = false;
  bool alone = true;                         ///< no other solution comes so near in evidence at all
  std::vector<Node> nodes;                   ///< one more than knots
  std::vector<Eigen::Matrix3d> cov_phi_T;    ///< of each node's attitude, R_LT Exp(phi) [rad^2]
  std::vector<LinkedErrors> marked;          ///< in the order of time
  ErrorVector errors = ErrorVector::Zero();  ///< of the tool, as found
  ErrorVector sigma_errors = ErrorVector::Zero();  ///< 0: has no prior
  ErrorMatrix cov_errors = ErrorMatrix::Zero();    ///< of `errors`
  ErrorMatrix cov_prior = ErrorMatrix::Zero();     ///< before the run
  RunState end;
  Diagnosis diagnosis;                 ///< where the setup asks for it
  std::vector<NorthClosure> closures;  ///< of the setup's norths
};

/// Solves the run from each start and keeps the solution of greatest evidence; where there is no
/// start, from what eight headings lead to: the motion itself shows north. Where no start leads to
/// a solution that the gyros fit the other guess is tried. Where the residuals of gyros or
/// accelerometers are larger than the noise stated can make them, that sensor's noise is
/// taken as large as they say, and the run is solved with it (variance components, Foerstner 1979):
/// covariances hold for what was measured, not for what was promised. Noise is never taken smaller.
/// `marked`: nodes whose linked errors are wanted, ascending. Of a part of a run: what is known
/// where it begins, whose setup counts but for what ties it. Unsolved where there is no knot, or
/// where no start leads to a solution.
WELLGYRO_EXPORT RunEstimate EstimateRun(const EstimateSetup& setup, std::span<const RunKnot> knots,
                                        const Starts& starts, std::span<const std::size_t> marked,
                                        const RunState* before = nullptr);

}  // namespace wellgyro
