#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/error_source.h"

namespace wellgyro {

/// Errors that stay linked from station to station: attitude, walk and Markov part of three
/// gyros, and those of the run, at most.
inline constexpr int kStationErrorsMax = 3 + 2 * 3 + kRunErrorsMax;

/// For reckoning with them: nothing is allocated.
using StationMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kStationErrorsMax, kStationErrorsMax>;

/// A run's state at one station: all that the position covariance needs. A run keeps thousands:
/// matrices are as large as the errors that the run has.
///
/// The errors x of the stations form a Markov chain in time, and so in either order of depth:
/// `cov` and `cov_with_previous` of all stations of a run hold every correlation among them.
struct StationState {
  std::size_t knot = 0;  ///< of the run, at whose end it is
  AttitudeSample attitude;
  AlongHole along;
  Eigen::MatrixXd cov;                ///< E[x x'], x begins with phi of R_LT Exp(phi) [rad]
  Eigen::MatrixXd cov_with_previous;  ///< E[x_previous x'], previous in time; empty for the first
  /// Error of the tangent in L by phi: regular at every inclination.
  Eigen::Matrix3d tangent_by_phi_L = Eigen::Matrix3d::Zero();
};

}  // namespace wellgyro
