#pragma once

#include <cmath>

#include "wellgyro/record/along_hole.h"

namespace wellgyro {

/// Prior of the hole's bend over an interval without valid samples: an angle of
/// N(0, (dogleg |dMD|)^2) where the depth is known, 2.9 deg in 30 m, and N(0, (rate dt)^2) where it
/// is not, as much at 1 m/s. `seconds`: how long a bend goes on from one such interval to the next,
/// a stand of 30 m at 0.3 m/s, see UnseenTurn.
struct UnseenHole {
  double dogleg = 1.7e-3;  ///< 1-sigma, where the depth is known [rad/m]
  double rate = 1.7e-3;    ///< 1-sigma, across the hole, where it is not [rad/s]
  double seconds = 100;

  /// How fast it may turn, 1-sigma [rad/s].
  double RateAt(const AlongHole& along) const {
    return along.known ? dogleg * std::abs(along.speed) : rate;
  }
};

/// Variance of an unobserved turn in several parts. With x the angle missed before, fading as
/// x' = -x / seconds while samples are valid, a part of angle a adds (x + a)^2 - x^2 = a (2 x + a).
/// A bend that runs through several short gaps is one bend: its parts add in amplitude. Added as
/// squares they would count as independent, and the sigma would be too small.
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
