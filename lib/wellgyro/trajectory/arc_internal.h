#pragma once

#include <array>

#include <Eigen/Core>

namespace wellgyro {

/// The arc of one leg seen from its middle, the only form that stays exact from straight legs to
/// half circles.
struct Arc {
  double length = 0;     ///< [m]
  double curvature = 0;  ///< [1/m]
  double middle_z = 0;   ///< TVD of its middle [m]
  double along_z = 0;    ///< of the unit tangent there
  double across_z = 0;   ///< of the unit normal there, towards the centre
};

Arc MakeArc(double length, double begin_z, const Eigen::Vector3d& t1_W,
            const Eigen::Vector3d& t2_W);

/// Least and greatest TVD on it; `begin_z` and `end_z` are its ends' [m].
Eigen::Vector2d RangeOf(const Arc& arc, double begin_z, double end_z, double t1_z, double t2_z);

/// Where it is at TVD `z`, which lies in its range.
struct Crossings {
  int count = 0;                  ///< 1 or 2; or 2 with the whole leg level
  bool level = false;             ///< it lies in `z` from begin to end
  std::array<double, 2> s{0, 0};  ///< from its begin [m], increasing
};
Crossings CrossingsAt(const Arc& arc, double z);

}  // namespace wellgyro
