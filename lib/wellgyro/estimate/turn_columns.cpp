#include "wellgyro/estimate/turn_columns.h"

namespace wellgyro {
namespace {

using Eigen::Vector2d;

Vector2d QuarterTurned(const Vector2d& v) { return {-v.y(), v.x()}; }

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

}  // namespace wellgyro
