#pragma once

#include <Eigen/Core>

#include "wellgyro/earth/earth.h"

namespace wellgyro {

/// Where the path stands within a knot, held fixed while its rows are made linear.
struct KnotPlace {
  Site site;
  Eigen::Vector3d w_IL_L = Eigen::Vector3d::Zero();  ///< Earth's rate and transport [rad/s]
  Eigen::Vector3d dw_by_latitude_L = Eigen::Vector3d::Zero();
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
  /// Mean over the knot of the roll less psi less a turn at constant rate [rad], where gravity does
  /// not show the roll; else 0. See BowKnots().
  double roll_bow = 0;
  double since_start = 0;  ///< middle of the knot [s]
  double depth = 0;        ///< vertical, below node 0 [m]
};

}  // namespace wellgyro
