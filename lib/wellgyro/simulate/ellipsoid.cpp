#include "wellgyro/simulate/ellipsoid.h"

#include <cmath>

namespace wellgyro {
namespace {

// WGS 84, NIMA TR8350.2, third edition, tables 3.1, 3.3 and 3.4.
constexpr double kA = 6378137.0;          // [m]
constexpr double kF = 1 / 298.257223563;  // [1]
constexpr double kE2 = kF * (2 - kF);     // [1]
constexpr double kGammaE = 9.7803253359;  // at the equator [m/s^2]
constexpr double kSomigliana = 0.00193185265241;
constexpr double kM = 0.00344978650684;    // centrifugal over gravity at the equator [1]
constexpr double kGrowthInRock = 0.85e-6;  // [1/s^2]

}  // namespace

EllipsoidPlace EllipsoidAt(double sin_latitude, double height) {
  const double s2 = sin_latitude * sin_latitude;
  const double w2 = 1 - kE2 * s2;
  const double w = std::sqrt(w2);
  const double on_ellipsoid = kGammaE * (1 + kSomigliana * s2) / w;
  double gravity = on_ellipsoid - kGrowthInRock * height;
  if (height > 0) {
    const double ratio = height / kA;
    gravity = on_ellipsoid * (1 - 2 * (1 + kF + kM - 2 * kF * s2) * ratio + 3 * ratio * ratio);
  }
  return {.radius_north = kA * (1 - kE2) / (w2 * w) + height,
          .radius_east = kA / w + height,
          .gravity = gravity};
}

}  // namespace wellgyro
