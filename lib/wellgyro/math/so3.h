#pragma once

#include <Eigen/Core>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// The matrix of the cross product, Skew(v) u = v x u.
WELLGYRO_EXPORT Eigen::Matrix3d Skew(const Eigen::Vector3d& v);

/// Rotation by |v| about v (Rodrigues), to the last bits for any v, small ones included.
WELLGYRO_EXPORT Eigen::Matrix3d Exp(const Eigen::Vector3d& v);

/// The mean of Exp(s v) over s from 0 to 1, by which an error of v turns what Exp(v) has turned:
/// Exp(v + d) = Exp(LeftJacobian(v) d) Exp(v) to the first order of d. To the last bits for any v.
WELLGYRO_EXPORT Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& v);

/// The rotation vector of R, |v| in [0, pi]: Exp(Log(R)) = R. Relative accuracy 1e-15 up to an
/// angle of 3; near pi, where the axis comes from vanishing differences, 1e-16/(pi - angle).
WELLGYRO_EXPORT Eigen::Vector3d Log(const Eigen::Matrix3d& R);

}  // namespace wellgyro
