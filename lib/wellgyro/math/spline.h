#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Slopes, at every x, of the cubic spline through (x, y) whose third derivative is continuous at
/// the second point and the last but one ("not a knot"; de Boor, A Practical Guide to Splines,
/// chapter IV). Evenly spaced by h and away from the ends they err by h^4 / 180 times the fifth
/// derivative. Two points: their line; three: their parabola. x increases and has y's size, at
/// least 2.
WELLGYRO_EXPORT std::vector<Eigen::Vector3d> SplineSlopes(std::span<const double> x,
                                                          std::span<const Eigen::Vector3d> y);

}  // namespace wellgyro
