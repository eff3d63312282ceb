#pragma once

namespace wellgyro {

/// (sqrt(5) - 1) / 2.
inline constexpr double kGolden = 0.6180339887498949;

/// Golden section: where `cost` is least between `low` and `high`, if it has one minimum there.
/// Each turn leaves the fraction kGolden of the interval about the minimum; another follows as long
/// as `goes_on(low, high)`. The middle of the interval that is left.
template <class Cost, class GoesOn>
double GoldenSection(double low, double high, Cost&& cost, GoesOn&& goes_on) {
  while (goes_on(low, high)) {
    const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    if (cost(a) < cost(b)) {
      high = b;
    } else {
      low = a;
    }
  }
  return (low + high) / 2;
}

}  // namespace wellgyro
