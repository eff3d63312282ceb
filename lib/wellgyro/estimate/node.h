#pragma once

#include <Eigen/Core>

#include "wellgyro/estimate/layout.h"
#include "wellgyro/math/so3.h"

namespace wellgyro {

/// The run's unknowns at one instant between two knots, as now known.
struct Node {
  Eigen::Matrix3d R_LT = Eigen::Matrix3d::Identity();
  double roll_rate = 0;  ///< inertial, over the knot behind it, without the swing [rad/s]
  double md = 0;         ///< of the sensor point [m]
  double speed = 0;      ///< along the hole [m/s]
  Eigen::Vector3d walk_T = Eigen::Vector3d::Zero();    ///< drift of the gyros x, y, z [rad/s]
  Eigen::Vector3d markov_T = Eigen::Vector3d::Zero();  ///< the same, that which forgets [rad/s]
  Eigen::Vector2d swing = Eigen::Vector2d::Zero();     ///< of the roll rate [rad/s]

  Eigen::Vector3d tangent_L() const { return R_LT.col(2); }
};

/// What acts across the axis alone.
inline Eigen::Vector3d Flat(const Eigen::Vector2d& v) { return {v.x(), v.y(), 0}; }

/// d tangent_L / d phi = -R [e_z]x, phi of R_LT Exp(phi).
inline Eigen::Matrix3d TangentByPhi(const Eigen::Matrix3d& R_LT) {
  return -R_LT * Skew(Eigen::Vector3d::UnitZ());
}

/// Variance of a turn about the vertical, by phi's covariance [rad^2].
inline double HeadingVariance(const Eigen::Matrix3d& R_LT, const Eigen::Matrix3d& cov_phi_T) {
  const Eigen::Vector3d down_T = R_LT.row(2).transpose();
  return down_T.dot(cov_phi_T * down_T);
}

/// The node moved by a step of its unknowns.
inline void Move(const Layout& layout, const NodeVector& step, Node& node) {
  node.R_LT = node.R_LT * Exp(step.segment<3>(layout.phi));
  node.roll_rate += step[layout.roll];
  node.md += step[layout.depth];
  node.speed += step[layout.speed];
  const int gyros = layout.gyros;
  if (layout.walk != kAbsent) node.walk_T.head(gyros) += step.segment(layout.walk, gyros);
  if (layout.markov != kAbsent) node.markov_T.head(gyros) += step.segment(layout.markov, gyros);
  if (layout.swing != kAbsent) node.swing += step.segment<2>(layout.swing);
}

}  // namespace wellgyro
