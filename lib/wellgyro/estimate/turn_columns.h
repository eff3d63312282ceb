#pragma once

#include <array>

#include <Eigen/Core>

#include "wellgyro/record/error_source.h"
#include "wellgyro/record/increment.h"

namespace wellgyro {

/// Errors that change a turn: those that an increment has columns of, and others made of these.
inline constexpr std::array kTurns{
    kGyroBiasX,  kGyroBiasY,           kMassUnbalance, kQuadrature,     kGyroScaleX,
    kGyroScaleY, kMisalignmentX,       kMisalignmentY, kToolfaceOffset, kTimeSkew,
    kGyroShear,  kUnbalanceDifference, kQuadratureSum};
static_assert(kTurns[kTurnSources] == kGyroShear);
using TurnByError = Eigen::Matrix<double, 2, kTurns.size()>;

/// d turn_M / d error of these. With the rates w and the mean force f across, as e^{i psi} turns
/// them back, the last are of w_y + i w_x, and of f_x - i f_y and f_y + i f_x.
TurnByError TurnBy(const Increment& increment);

/// Errors in variables (Fuller, Measurement Error Models, 1987, section 1.2): a scale error
/// multiplies the true turn, and the reading is the true turn plus noise. With readings for
/// regressors the square of the noise biases every scale upwards, by one over its information a
/// knot: by three sigmas of a prior of 1e-4 in 16 h. So the residual of the turn, `left` (attitudes
/// less gyros, in M), is added to the regressors, to each axis its share.
TurnByError WithoutNoise(const Increment& inc, TurnByError by_error, const Eigen::Vector2d& left);

/// By which what skewed gyros (kMisalignmentX, Y, columns) seem to turn leads, in the mean of the
/// knot's forces, half of what it is over the knot. It is a circle, (e^{i psi} - 1) / i from the
/// middle on, psi the roll from there: its mean less that of its ends.
Eigen::Matrix2d SkewBeforeHalf(const Increment& inc);

}  // namespace wellgyro
