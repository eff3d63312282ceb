#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/trajectory/path.h"

namespace wellgyro {

/// One point of a trajectory.
struct TrajectoryPoint {
  double md = 0;           ///< [m]
  double inclination = 0;  ///< [rad]
  double azimuth = 0;      ///< of the trajectory's own north [rad], [0, 2 pi)
  Eigen::Vector3d position_W = Eigen::Vector3d::Zero();  ///< north, east, TVD [m]
  Eigen::Vector3d tangent_W = Eigen::Vector3d::UnitZ();
  double dogleg_severity = 0;  ///< of the leg it lies in; at a station, the one that ends [rad/m]
};

/// A survey as a curve: circular arcs between stations, one north for all azimuths. Never changes
/// once made, so that any number of threads may ask it at once.
///
/// By MD in O(log n), by TVD in O(log n) for each depth found. Where the hole is exactly vertical
/// its azimuth is the one carried from the station above.
class WELLGYRO_EXPORT Trajectory {
 public:
  /// Ties the stations onto `start_W` (north, east, TVD) [m], the position of the first. `md` [m],
  /// angles [rad]. Throws std::invalid_argument naming the station, counted from 0, when sizes
  /// differ, there is none, a value is not finite, depth does not increase or two directions are
  /// opposite.
  Trajectory(std::span<const double> md, std::span<const double> inclination,
             std::span<const double> azimuth, const Eigen::Vector3d& start_W);

  /// The points of a Path, in W: azimuths refer to the meridian of the well head from here on.
  /// Throws std::invalid_argument when there is none or depth does not increase.
  static Trajectory OfPath(std::span<const PathPoint> points);

  /// A side-track: `parent` at `md`, then `stations` below it, whose azimuths refer to the parent's
  /// north. Throws as the constructor, and std::domain_error when `md` is not on the parent.
  static Trajectory TiedOnto(const Trajectory& parent, double md,
                             std::span<const PathStation> stations);

  std::size_t size() const { return md_.size(); }
  TrajectoryPoint station(std::size_t i) const;
  double md_begin() const { return md_.front(); }
  double md_end() const { return md_.back(); }

  /// The point at measured depth `md`. Throws std::domain_error outside [md_begin, md_end].
  TrajectoryPoint AtMd(double md) const;

  /// Every measured depth at which the hole is at `tvd` [m], in order: none, one, or several where
  /// it rises. Where it touches the level to 1e-9 m, one; where it lies in it, the begin and end of
  /// the stretch. Good to 1e-9 m where the hole crosses steeply; near a touching point as the
  /// square root of the rounding of TVD, 1e-4 m.
  std::vector<double> MdAtTvd(double tvd) const;

  /// Points at whole multiples of `spacing` [m], the first and the last station, and with
  /// `keep_stations` every station. Throws std::invalid_argument unless 0 < spacing.
  std::vector<TrajectoryPoint> Resampled(double spacing, bool keep_stations = false) const;

  /// The point `length` metres beyond the last station on a curve of constant `dogleg_severity`
  /// [rad/m] that leaves in the direction of `toolface` [rad] from the high side; straight when the
  /// severity is zero. Throws std::invalid_argument when length or severity is negative or not
  /// finite, or the curve turns by pi or more.
  TrajectoryPoint Ahead(double length, double dogleg_severity = 0, double toolface = 0) const;

 private:
  Trajectory() = default;
  void Index();

  std::vector<double> md_, inclination_, azimuth_, severity_;
  std::vector<Eigen::Vector3d> position_W_, tangent_W_;
  /// A heap of ranges of TVD over the legs: node k over 2k and 2k + 1, leaves from leaves_.
  std::vector<Eigen::Vector2d> range_;
  std::size_t leaves_ = 0;
};

}  // namespace wellgyro
