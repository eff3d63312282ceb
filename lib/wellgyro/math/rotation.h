#pragma once

#include <Eigen/Core>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Right-handed rotations about one axis by `angle` [rad].
WELLGYRO_EXPORT Eigen::Matrix3d RotationX(double angle);
WELLGYRO_EXPORT Eigen::Matrix3d RotationY(double angle);
WELLGYRO_EXPORT Eigen::Matrix3d RotationZ(double angle);

/// The angle in [-pi, pi] by which RotationZ() comes nearest to a rotation, in the Frobenius norm
/// [rad]: of R_LT the heading of a tool near vertical. Of a half turn about a horizontal axis it is
/// any.
WELLGYRO_EXPORT double AngleAboutZ(const Eigen::Matrix3d& rotation);

/// R_LT = Rz(azimuth) Ry(inclination) Rz(toolface): tool T to local level L (north, east, down).
WELLGYRO_EXPORT Eigen::Matrix3d AttitudeMatrix(double azimuth, double inclination, double toolface);

/// Unit tangent of the hole in L: (sin I cos A, sin I sin A, cos I).
WELLGYRO_EXPORT Eigen::Vector3d Tangent(double inclination, double azimuth);

/// Inclination, atan2 regular at vertical, and azimuth in [0, 2 pi), 0 at vertical, of a vector
/// along the hole, of any length [rad].
WELLGYRO_EXPORT double InclinationOf(const Eigen::Vector3d& axis_L);
WELLGYRO_EXPORT double AzimuthOf(const Eigen::Vector3d& axis_L);

/// Derivative of Tangent() by (inclination, azimuth): the high side and, sin I times as long, the
/// right.
WELLGYRO_EXPORT Eigen::Matrix<double, 3, 2> TangentByAngles(double inclination, double azimuth);

}  // namespace wellgyro
