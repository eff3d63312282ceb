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

}  // namespace wellgyro
