#include "wellgyro/attitude/roll_following_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace wellgyro::increment {
namespace {

// int s^2 dx / pi beyond x = pi n, which n phases do not have: 2 / (pi^2 n) = 5 % at four.
constexpr double kFewest = 4;
// g at a = 0, 1, ... 10, by quadrature.
constexpr std::array kLow{1.0,   0.963, 0.825, 0.682, 0.630, 0.687,
                          0.817, 0.969, 1.121, 1.256, 1.386};
// v / 2 of the smoothed phase's own variance v = (R / T) a / pi int_0^inf dx / (1 + x^4)^2, which
// is 3 a / (16 sqrt 2), and g less that at 10.
constexpr double kSlope = 0.13258, kRest = 0.06;

}  // namespace

double LateralVariance(double a, double blocks) {
  if (!(a > 0) || blocks < kFewest) return 1;
  double g = kSlope * a + kRest;
  if (a < kLow.size() - 1) {
    const double below = std::floor(a);
    const auto i = static_cast<std::size_t>(below);
    g = kLow[i] + (a - below) * (kLow[i + 1] - kLow[i]);
  }
  return std::min(g, std::max(1.0, 0.5 * blocks));
}

}  // namespace wellgyro::increment
