#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/attitude/filter_state.h"
#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"

namespace wellgyro {

/// Whether the tool met the stations in the order of depth (in-run) or against it (out-run).
enum class TimeAlongHole { kWithDepth, kAgainstDepth };

/// Position covariance, summed from station to station down the hole.
///
/// The position error of a leg is dMD/2 (g_k x_k + g_k+1 x_k+1), x the error of inclination and
/// azimuth and g the derivative of the tangent (balanced tangential, ISCWSA); the errors of all
/// stations are correlated as their Markov chain says, exactly, at a cost that does not grow with
/// the number of stations before. To each station comes its depth error along the tangent.
class WELLGYRO_EXPORT AlongHoleCovariance {
 public:
  /// `cov_tie_in`: of the position of the first station [m^2]; `depth_sigma`: ErrorPriors [m], of
  /// which and AlongHole::sigma_md the larger counts.
  AlongHoleCovariance(const Eigen::Matrix3d& cov_tie_in, double depth_sigma, TimeAlongHole order);

  /// The next station of the survey in the order of depth. Returns cov_p_WT_W [m^2].
  /// The stations of one filter or smoother must come one after the other, each the neighbour in
  /// time of the one before; one without `cov_with_previous`, the first of a run, is taken as
  /// independent of its neighbour. Throws std::invalid_argument when depths do not increase or
  /// time runs the wrong way.
  Eigen::Matrix3d Add(const StationState& station);

  /// The same for a station that the survey leaves out: it only carries the correlations on. Its
  /// depth does not matter.
  void Skip(const StationState& station);

 private:
  using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kFilterStatesMax>;
  void Advance(const StationState& station);

  TimeAlongHole order_;
  double depth_sigma_;
  bool any_ = false;
  double md_ = 0;                   // of the last station added, and there:
  Eigen::Matrix3d cov_;             // of r, the position less the station's own depth error
  Eigen::Matrix3d cov_slope_;       // of s, the error of the tangent
  Eigen::Matrix3d cov_with_slope_;  // E[r s']
  Rows cov_with_state_;             // E[r x'], x of the station last seen, added or skipped
  Rows slope_with_state_;           // E[s x']
  // The same with the part of the inclination's error that is in no state, and its variance there.
  Eigen::Vector3d cov_with_lean_, slope_with_lean_;
  double lean_variance_ = 0;
  ToolTime time_;          // of that station
  std::size_t epoch_ = 0;  // of that station
  FilterMatrix state_cov_, state_cov_with_previous_;
};

/// The same for all stations at once, in the order of depth.
WELLGYRO_EXPORT std::vector<Eigen::Matrix3d> CovarianceAlongHole(
    std::span<const StationState> in_depth_order, TimeAlongHole order,
    const Eigen::Matrix3d& cov_tie_in, double depth_sigma);

}  // namespace wellgyro
