#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "wellgyro/attitude/station_state.h"
#include "wellgyro/base/export.h"

namespace wellgyro {

/// Whether the tool met the stations in the order of depth (in-run) or against it (out-run).
enum class TimeAlongHole { kWithDepth, kAgainstDepth };

/// Regression of x2 on x1, X = cov(x1)^-1 E[x1 x2'], `cross` being the cross-covariance E[x1 x2'].
/// By the Markov property E[r x2'] = E[r x1'] X for every r that is independent of x2 given x1. A
/// singular cov leaves X undetermined without effect on that product; the smallest X is returned.
StationMatrix SolveCovariance(const StationMatrix& cov, const StationMatrix& cross);

/// Position covariance, summed from station to station down the hole.
///
/// The position error of a leg is dMD/2 (s_k + s_k+1), s the error of the tangent (balanced
/// tangential, ISCWSA); the errors of all stations are correlated as their Markov chain says,
/// exactly, at a cost that does not grow with the number of stations before. To each station comes
/// its depth error along the tangent.
class WELLGYRO_EXPORT AlongHoleCovariance {
 public:
  /// `cov_tie_in_W`: of the position of the first station [m^2]; `depth_sigma`: ErrorPriors [m], of
  /// which and AlongHole::sigma_md the larger counts.
  AlongHoleCovariance(const Eigen::Matrix3d& cov_tie_in_W, double depth_sigma, TimeAlongHole order);

  /// The next station of the survey in the order of depth. Returns cov_p_WT_W [m^2].
  /// The stations of one run must come one after the other, each the neighbour in time of the one
  /// before; one without `cov_with_previous`, the first of a run, is taken as independent of its
  /// neighbour. Throws std::invalid_argument when depths do not increase, time runs the wrong way,
  /// or `cov_with_previous` is of another number of errors than its neighbour has.
  Eigen::Matrix3d Add(const StationState& station);

  /// The same for a station that the survey leaves out: it only carries the correlations on. Its
  /// depth does not matter.
  void Skip(const StationState& station);

  /// Of the station last added, less its own depth error [m^2].
  const Eigen::Matrix3d& cov_without_depth_W() const { return cov_W_; }

 private:
  using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kStationErrorsMax>;
  void Advance(const StationState& station);

  TimeAlongHole order_;
  double depth_sigma_;
  bool any_ = false;
  double md_ = 0;                     // of the last station added, and there:
  Eigen::Matrix3d cov_W_;             // of r, the position less the station's own depth error
  Eigen::Matrix3d cov_slope_W_;       // of s, the error of the tangent, L taken for W
  Eigen::Matrix3d cov_with_slope_W_;  // E[r s']
  Rows cov_with_state_;               // E[r x'], x of the station last seen, added or skipped
  Rows slope_with_state_;             // E[s x']
  std::size_t knot_ = 0;              // of that station
  StationMatrix state_cov_, state_cov_with_previous_;
};

}  // namespace wellgyro
