#pragma once

#include <algorithm>
#include <cmath>

#include "wellgyro/estimate/cause.h"

namespace wellgyro {

/// ln B of a cause whose size is N(0, v), v = size^2, against none, by the score s and information
/// M of its column:
///   s^2 / (2 (M + 1/v)) - ln(1 + v M) / 2.
inline double LnBayes(double score, double information, double size) {
  const double v = size * size;
  return 0.5 * score * score / (information + 1 / v) - 0.5 * std::log1p(v * information);
}

/// The smallest fault whose ln B passes `ln_limit` with the power of kNoticedPower. ln B passes it
/// at
///   w^2 = (1 + 1/(v M)) (2 ln_limit + ln(1 + v M)),  w = s / sqrt(M).
inline double SmallestNoticed(double information, double size, double ln_limit) {
  const double vm = size * size * information;
  const double w2 = (1 + 1 / vm) * (2 * ln_limit + std::log1p(vm));
  return (std::sqrt(std::max(w2, 0.0)) + kNoticedPower) / std::sqrt(information);
}

}  // namespace wellgyro
