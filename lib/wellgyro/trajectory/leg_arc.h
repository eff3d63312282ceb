#pragma once

#include <Eigen/Core>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// One leg of a hole as the circular arc that it is, from its begin on.
struct LegArc {
  Eigen::Vector3d begin_W = Eigen::Vector3d::Zero();     ///< [m]
  Eigen::Vector3d tangent_W = Eigen::Vector3d::UnitZ();  ///< there
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitX();   ///< there, towards the centre
  double length = 0;                                     ///< [m]
  double curvature = 0;                                  ///< [1/m]; 0: straight
};

/// The arc of `length` [m] from `begin_W` that leaves along the unit vector `t1_W` and arrives
/// along `t2_W`; the caller has made sure that there is one (dogleg below kDoglegLimit). Directions
/// nearer to each other than 1e-12 rad are one.
WELLGYRO_EXPORT LegArc MakeLegArc(const Eigen::Vector3d& begin_W, double length,
                                  const Eigen::Vector3d& t1_W, const Eigen::Vector3d& t2_W);

/// The point `s` metres along, and the unit tangent there; no cancellation at any curvature.
WELLGYRO_EXPORT Eigen::Vector3d PointOn(const LegArc& arc, double s);
WELLGYRO_EXPORT Eigen::Vector3d DirectionOn(const LegArc& arc, double s);

/// Where on the arc [m] it is nearest to `point_W`: in closed form, the projection onto the circle
/// or one of the ends. Every place serves where the point lies on the circle's axis.
WELLGYRO_EXPORT double NearestOn(const LegArc& arc, const Eigen::Vector3d& point_W);

/// Where the arc goes through the plane that holds `point_W` across the unit vector `across_W`:
/// none, one or two places [m], increasing. An arc that lies in the plane has none.
struct PlaneCrossings {
  int count = 0;
  double s[2] = {0, 0};
};
WELLGYRO_EXPORT PlaneCrossings CrossingsOfPlane(const LegArc& arc, const Eigen::Vector3d& point_W,
                                                const Eigen::Vector3d& across_W);

/// Where two arcs are nearest to each other.
struct NearestPair {
  double s_first = 0, s_second = 0;  ///< along either [m]
  double distance = 0;               ///< [m]
};

/// The nearest points of two arcs, of all the minima there are, to 1e-7 m in distance.
///
/// With u(s) nearest on the second to the first's point at s, the square of the distance g(s) is
/// the least of functions whose second derivative is at most 2 (1 + curvature * distance); so on
/// any interval g lies above the chord less a known parabola, and an interval that cannot hold a
/// nearer point is left out. What remains is halved; a minimum is closed in upon by the sign of the
/// derivative. Two straight legs are solved directly. Where the arcs run beside each other at one
/// distance any pair may come back.
WELLGYRO_EXPORT NearestPair NearestBetween(const LegArc& first, const LegArc& second);

}  // namespace wellgyro
