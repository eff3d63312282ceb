#pragma once

namespace wellgyro {

/// 1-sigma of node 0's roll rate, and of a swing's, before any knot: that of a tool at 100 rpm says
/// nothing against any measurement [rad/s].
inline constexpr double kAnyRoll = 10;

/// Newton's decrements squared below which another roll walk can be told from the last, and from
/// which on it is not worth while: one sigma, and a hundred, over all unknowns together.
inline constexpr double kNear = 1, kFar = 1e4;

/// How far further steps may take the evidence, over the decrement squared d of the last one: in
/// all d (1 + 0.9 + 0.9^2 ...) = 10 d where each has nine tenths of the one before. And by how much
/// a trend of decrements may be wrong.
inline constexpr double kGain = 10;

}  // namespace wellgyro
