#include "wellgyro/estimate/turn_columns.h"

#include <cmath>

#include "wellgyro/math/plane.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/math/sinc.h"

namespace wellgyro {
namespace {

using Eigen::Vector2d;

/// Mean over a knot that rolls steadily of e e', e the direction of the tool's x axis in M.
Eigen::Matrix2d MeanSquareOfX(const Increment& inc) {
  const double roll = inc.roll(), ahead = inc.roll_after - inc.roll_before;
  const double c = Sinc(roll) * std::cos(ahead), s = Sinc(roll) * std::sin(ahead);
  return 0.5 * (Eigen::Matrix2d() << 1 + c, s, s, 1 - c).finished();
}

}  // namespace

TurnByError TurnBy(const Increment& inc) {
  TurnByError by_error;
  by_error.leftCols<kTurnSources>() = inc.turn_by_error;
  by_error.col(kTurnSources) =
      QuarterTurned(inc.turn_by_error.col(kGyroScaleX) - inc.turn_by_error.col(kGyroScaleY));
  const Vector2d f = inc.ForceBy(kAccelScaleX).head<2>() - inc.ForceBy(kAccelScaleY).head<2>();
  by_error.col(kTurnSources + 1) = inc.seconds * f;
  by_error.col(kTurnSources + 2) = inc.seconds * QuarterTurned(f);
  return by_error;
}

TurnByError WithoutNoise(const Increment& inc, TurnByError by_error, const Vector2d& left) {
  const Vector2d of_x = MeanSquareOfX(inc) * left;
  by_error.col(kGyroScaleX) += of_x;
  by_error.col(kGyroScaleY) += left - of_x;
  return by_error;
}

Eigen::Matrix2d SkewBeforeHalf(const Increment& inc) {
  const Vector2d ends =
      0.5 * (RotationZ(inc.roll_after) + RotationZ(-inc.roll_before)).topLeftCorner<2, 1>();
  const Vector2d d = inc.ForceBy(kAccelBiasX).head<2>() - ends;
  return (Eigen::Matrix2d() << d.y(), d.x(), -d.x(), d.y()).finished();
}

}  // namespace wellgyro
