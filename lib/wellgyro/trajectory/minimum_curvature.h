#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/export.h"

/// @file
/// From directions along the hole to positions, by minimum curvature.
namespace wellgyro {

/// Doglegs from here on have no usable arc: between opposite directions every plane serves.
inline constexpr double kDoglegLimit = kPi - 1e-6;  ///< [rad]

/// One leg between two stations: a circular arc that is tangent to both, in any frame.
struct ArcLeg {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< from its begin to its end [m]
  double dogleg = 0;                                       ///< angle between its ends [rad]
};

/// The arc of `length` [m] that leaves along the unit vector `t1` and arrives along `t2`.
///
/// With q = |t2 - t1| / |t2 + t1| = tan(dogleg / 2) the ratio factor is q / atan(q), taken from its
/// series for small q: no cancellation at any dogleg, exact for a straight leg. Relative error
/// below 1e-15 / (pi - dogleg). Empty at doglegs of kDoglegLimit and more, and when an argument is
/// not finite. Source: S. J. Sawaryn and J. L. Thorogood, SPE 84246, in half-angle form.
/// In any frame.
WELLGYRO_EXPORT std::optional<ArcLeg> MinimumCurvatureLeg(double length, const Eigen::Vector3d& t1,
                                                          const Eigen::Vector3d& t2);

/// Unit tangent at `fraction` of the way along the arc from `t1` to `t2`, in their plane; beyond
/// [0, 1] the circle goes on. Good to 1e-15 for any dogleg below kDoglegLimit, zero included; the
/// caller has made sure that there is an arc. In any frame.
WELLGYRO_EXPORT Eigen::Vector3d TangentOnArc(const Eigen::Vector3d& t1, const Eigen::Vector3d& t2,
                                             double fraction);

/// Minimum curvature over whole arrays, on a flat Earth: every azimuth refers to one north.
///
/// `md` [m], `inclination` and `azimuth` [rad] per station; `position_W` receives (north, east,
/// TVD) [m], the first being `start_W`; `severity`, unless empty, the dogleg severity [rad/m] of
/// the leg that ends at each station, the first zero; `tangent_W`, unless empty, the unit tangents.
/// Nothing is allocated. Throws std::invalid_argument, naming the station counted from 0, when
/// sizes differ, a value is not finite, depth does not increase or by more than a double holds, or
/// a dogleg reaches kDoglegLimit; stations before it are written.
WELLGYRO_EXPORT void MinimumCurvature(std::span<const double> md,
                                      std::span<const double> inclination,
                                      std::span<const double> azimuth,
                                      const Eigen::Vector3d& start_W,
                                      std::span<Eigen::Vector3d> position_W,
                                      std::span<double> severity = {},
                                      std::span<Eigen::Vector3d> tangent_W = {});

}  // namespace wellgyro
