#include <cmath>
#include <stdexcept>
#include <string>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/grid.h"

namespace wellgyro {
namespace {

double Finite(double angle, const char* what) {
  if (std::isfinite(angle)) return angle;
  throw std::invalid_argument(std::string("AzimuthFrom: ") + what + " is not a finite number");
}

// True azimuth less azimuth from `north`.
double Offset(const AzimuthReference& reference, North north) {
  switch (north) {
    case North::kTrue:
      return 0;
    case North::kGrid:
      if (reference.convergence) return Finite(*reference.convergence, "the grid's convergence");
      throw std::invalid_argument("AzimuthFrom: the grid's convergence is not given");
    case North::kMagnetic:
      if (reference.declination) return Finite(*reference.declination, "the declination");
      throw std::invalid_argument("AzimuthFrom: the declination is not given");
    case North::kUnknown:
      break;
  }
  throw std::invalid_argument("AzimuthFrom: which north the azimuths count from is not known");
}

}  // namespace

double AzimuthFrom(const AzimuthReference& reference, double azimuth, North from, North to) {
  if (from == to && from != North::kUnknown) return WrapTwoPi(azimuth);
  const double true_azimuth = azimuth + Offset(reference, from);
  return WrapTwoPi(true_azimuth - Offset(reference, to));
}

}  // namespace wellgyro
