#pragma once

#include <cmath>

namespace wellgyro {

/// sin(x) / x, to the last bits at any x; the series' next term is below 1e-17 where it is used.
inline double Sinc(double x) {
  if (std::abs(x) < 1e-2) {
    const double x2 = x * x;
    return 1 - x2 / 6 * (1 - x2 / 20 * (1 - x2 / 42));
  }
  return std::sin(x) / x;
}

}  // namespace wellgyro
