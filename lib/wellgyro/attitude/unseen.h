#pragma once

#include <algorithm>
#include <cmath>

#include "wellgyro/record/along_hole.h"

namespace wellgyro {

/// How much a hole may bend where no sensor sees it, and for how long it goes on so.
struct UnseenHole {
  double dogleg = 1.7e-3;  ///< 1-sigma, where the depth is known [rad/m]
  double rate = 1.7e-3;    ///< 1-sigma, across the hole, where it is not [rad/s]
  double seconds = 100;

  /// How far it may have turned over `span` [s] of the `apart` [s] between two places.
  double Between(const AlongHole& before, const AlongHole& next, double span, double apart) const {
    if (!before.known || !next.known) return rate * span;
    return dogleg * std::abs(next.md - before.md) * span / apart;
  }
  /// Over a sample whose rate stood at full scale having turned by `angle`: it may be as much
  /// again, and as much more as the hole may turn.
  double Beyond(const AlongHole& along, double angle, double dt) const {
    return std::max(along.known ? dogleg * std::abs(along.speed) * dt : rate * dt, angle);
  }
};

/// A turn that nothing told goes on as it does: parts that were missed shortly one after the other
/// add in amplitude.
class UnseenTurn {
 public:
  double VarOf(double angle) const { return angle * (2 * going_on_ + angle); }  ///< [rad^2]
  void Add(double angle) { going_on_ += angle; }
  /// Time that was seen; it goes on so for `seconds`.
  void Pass(double dt, double seconds) { going_on_ -= going_on_ * dt / seconds; }

 private:
  double going_on_ = 0;  // [rad]
};

}  // namespace wellgyro
