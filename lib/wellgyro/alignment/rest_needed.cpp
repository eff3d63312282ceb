#include "wellgyro/alignment/rest_needed.h"

#include <cmath>

#include "wellgyro/earth/earth.h"

namespace wellgyro {

std::optional<double> RestForSigma(double sigma_azimuth, const NoiseCoefficients& gyro,
                                   double latitude, double inclination, double azimuth) {
  constexpr double kLongest = 86400;  // [s], a day: where more is needed there is no such stop
  const double across =
      std::pow(std::cos(azimuth), 2) + std::pow(std::sin(azimuth) * std::cos(inclination), 2);
  const double rate = sigma_azimuth * kEarthRate * std::cos(latitude);
  const double seconds = std::pow(gyro.angle_random_walk / rate, 2) / across;
  return seconds <= kLongest ? std::optional(seconds) : std::nullopt;
}

}  // namespace wellgyro
