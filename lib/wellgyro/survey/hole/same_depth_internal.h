#pragma once

namespace wellgyro {

/// Depths [m] of surveys as read that are nearer than this are one depth, rounded twice.
inline constexpr double kRoundedDepth = 1e-6;

}  // namespace wellgyro
