#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/attitude_sample.h"

namespace wellgyro {

/// Errors the filter can carry: azimuth, drift of two axes (level, Gauss-Markov, ramp each), mass
/// unbalance, quadrature, scale x y, misalignment x y, toolface offset, time skew, accelerometer
/// bias x y z, latitude; an adjustment's also inclination and what passes differ by.
inline constexpr int kFilterStatesMax = 30;

/// Sized once for the errors whose prior is not zero; nothing is allocated.
using FilterVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kFilterStatesMax, 1>;
using FilterMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kFilterStatesMax, kFilterStatesMax>;

/// The filter's or smoother's state at one station: all that the position covariance needs.
///
/// The errors x of the stations form a Markov chain in time, and so in either order of depth:
/// `cov` and `cov_with_previous` of all stations of a run hold every correlation among them.
struct StationState {
  std::size_t epoch = 0;  ///< of FilterHistory::epochs
  AttitudeSample attitude;
  AlongHole along;
  FilterMatrix cov;                ///< E[x x'], state 0 is azimuth [rad]
  FilterMatrix cov_with_previous;  ///< E[x_previous x'], previous in time; empty for the first
  /// Error of (inclination, azimuth) = angles x + white, `white` independent from station to
  /// station with covariance `cov_white` [rad^2].
  Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, kFilterStatesMax> angles;
  Eigen::Matrix2d cov_white = Eigen::Matrix2d::Zero();
  /// Not quite: that of the inclination lasts so long, exp(-t / lean_seconds) [s].
  double lean_seconds = 0;
};

}  // namespace wellgyro
