#pragma once

#include <Eigen/Core>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// How many sigmas hold a normally distributed vector of `dimensions` with probability
/// `confidence`: the root of the chi-square quantile (0.95: 1.960, 2.448, 2.795). Throws
/// std::domain_error for a confidence outside (0, 1) or dimensions below 1.
WELLGYRO_EXPORT double ConfidenceFactor(double confidence, int dimensions);

/// The horizontal error ellipse.
struct ErrorEllipse {
  double semi_major = 0, semi_minor = 0;  ///< [m]
  double azimuth_major = 0;               ///< of the major axis, [0, pi) [rad]; 0 for a circle
};

/// Of the horizontal part of `cov` [m^2], holding the position with probability `confidence`.
WELLGYRO_EXPORT ErrorEllipse HorizontalEllipse(const Eigen::Matrix3d& cov, double confidence);

/// The ellipse that `cov`, seen along the unit vector `sight`, draws on the plane across it:
/// semi-axes as vectors in that plane, the longer first, at `sigmas` [m].
struct SeenEllipse {
  Eigen::Vector3d major, minor;
};
WELLGYRO_EXPORT SeenEllipse EllipseSeenAlong(const Eigen::Matrix3d& cov,
                                             const Eigen::Vector3d& sight, double sigmas);

/// The error ellipsoid: columns of `axes` are unit vectors, right-handed, longest first.
struct ErrorEllipsoid {
  Eigen::Vector3d semi_axes = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
};
WELLGYRO_EXPORT ErrorEllipsoid Ellipsoid(const Eigen::Matrix3d& cov, double confidence);

/// `cov` of (north, east, down) as that of (high side, lateral to the right, along) of a hole with
/// this inclination and azimuth [rad]; in a vertical hole high side points along the azimuth.
WELLGYRO_EXPORT Eigen::Matrix3d ToHighSide(const Eigen::Matrix3d& cov, double inclination,
                                           double azimuth);

}  // namespace wellgyro
