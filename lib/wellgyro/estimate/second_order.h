#pragma once

#include <Eigen/Core>

#include "wellgyro/record/error_source.h"
#include "wellgyro/record/increment.h"

namespace wellgyro {

/// d force_M / d error of the accelerometers' second order, a column a source from
/// kAccelSecondOrder on [(m/s^2)^2]. The force across the hole a = f_x + i f_y is F e^{-i psi}, psi
/// the roll from the knot's middle: what is fixed in T and goes by a^2 is turned back to means of
/// e^{-i psi} and e^{3 i psi}. The first, and that of e^{2 i psi}, the increment has; the last is
/// that of a knot that rolls steadily: where the roll changes within it by half of psi'' t^2, three
/// times that is wrong.
Eigen::Matrix<double, 3, kSecondOrderSources> ForceBySecondOrder(const Increment& increment);

}  // namespace wellgyro
