#pragma once

#include <span>

#include <Eigen/Core>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Of every ellipse and interval that summaries, documents and pages show.
inline constexpr double kConfidence = 0.95;

/// How many sigmas hold a normally distributed vector of `dimensions` with probability
/// `confidence`: the root of the chi-square quantile (0.95: 1.960, 2.448, 2.795). Throws
/// std::domain_error for a confidence outside (0, 1) or dimensions below 1.
WELLGYRO_EXPORT double ConfidenceFactor(double confidence, int dimensions);

/// The horizontal error ellipse.
struct ErrorEllipse {
  double semi_major = 0, semi_minor = 0;  ///< [m]
  double azimuth_major = 0;               ///< of the major axis, [0, pi) [rad]; 0 for a circle
};

/// Of the horizontal part of `cov_W` [m^2], holding the position with probability `confidence`.
WELLGYRO_EXPORT ErrorEllipse HorizontalEllipse(const Eigen::Matrix3d& cov_W, double confidence);

/// The least ellipse e' E^-1 e <= 1, by its trace, of the family that holds every sum of a point
/// within that of `a` and one within that of `b` [m^2]: E = (1 + 1/p) a + (1 + p) b with
/// p^2 = tr a / tr b (Kurzhanski and Valyi 1997, 2.2). Its half axis along n is at least the two
/// half widths together; where `a` and `b` are alike but for a factor, it is just that.
WELLGYRO_EXPORT Eigen::Matrix2d EllipseAboutSum(const Eigen::Matrix2d& a, const Eigen::Matrix2d& b);

/// The least ellipse e' E^-1 e <= 1 that holds all points [m^2], by Khachiyan's algorithm for
/// centred ellipses; zero without a point. One line of points has a width of a thousandth of it.
WELLGYRO_EXPORT Eigen::Matrix2d EllipseAbout(std::span<const Eigen::Vector2d> points);

/// The ellipse that `cov` of any frame, seen along the unit vector `sight`, draws on the plane
/// across it: semi-axes as vectors in that plane, the longer first, at `sigmas` [m].
struct SeenEllipse {
  Eigen::Vector3d major, minor;
};
WELLGYRO_EXPORT SeenEllipse EllipseSeenAlong(const Eigen::Matrix3d& cov,
                                             const Eigen::Vector3d& sight, double sigmas);

/// The error ellipsoid, any frame: columns of `axes` are unit vectors, right-handed, longest first.
struct ErrorEllipsoid {
  Eigen::Vector3d semi_axes = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
};
WELLGYRO_EXPORT ErrorEllipsoid Ellipsoid(const Eigen::Matrix3d& cov, double confidence);

/// `cov_W` of (north, east, down) as that of (high side, lateral to the right, along) of a hole
/// with this inclination and azimuth [rad]; in a vertical hole high side points along the azimuth.
WELLGYRO_EXPORT Eigen::Matrix3d ToHighSide(const Eigen::Matrix3d& cov_W, double inclination,
                                           double azimuth);

}  // namespace wellgyro
