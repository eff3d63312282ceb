#pragma once

namespace wellgyro {

/// 2 ln of odds of 90, or 3^2: a heading, or a solution of a run, does not beat another one whose
/// cost (chi-square, -2 ln likelihood) is larger by less. What is left out is the right one once in
/// 91 times.
inline constexpr double kDecides = 9;

}  // namespace wellgyro
