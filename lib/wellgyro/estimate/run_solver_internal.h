#pragma once

namespace wellgyro {

/// 1-sigma of node 0's roll rate, and of a swing's, before any knot: that of a tool at 100 rpm says
/// nothing against any measurement [rad/s].
inline constexpr double kAnyRoll = 10;

/// Newton's decrements squared below which another roll walk can be told from the last, and from
/// which on it is not worth while: one sigma, and a hundred, over all unknowns together.
inline constexpr double kNear = 1, kFar = 1e4;

/// What may be hoped for, as a multiple of what the linear model or a trend of decrements promises:
/// a margin, so that steps are not given up for the error of either.
inline constexpr double kGain = 10;

}  // namespace wellgyro
