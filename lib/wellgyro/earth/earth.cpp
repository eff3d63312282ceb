#include "wellgyro/earth/earth.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <GeographicLib/NormalGravity.hpp>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

// Free-air gradient 3.086e-6 less 4 pi G 2670 kg/m^3.
constexpr double kInteriorGradient = 0.85e-6;  // [1/s^2]

}  // namespace

Site SiteAt(double latitude, double height) {
  if (!(std::abs(latitude) <= kPi / 2) || !std::isfinite(height)) {
    throw std::domain_error(fmt::format(
        "SiteAt: latitude {} rad, height {} m is no place on the Earth", latitude, height));
  }
  const auto& wgs84 = GeographicLib::NormalGravity::WGS84();
  double up_north = 0, up = 0;
  wgs84.Gravity(ToDegrees(latitude), std::max(height, 0.0), up_north, up);
  const double e2 = wgs84.Flattening() * (2 - wgs84.Flattening());
  const double s = std::sin(latitude);
  const double w2 = 1 - e2 * s * s;
  const double prime_vertical = wgs84.EquatorialRadius() / std::sqrt(w2);
  return {.latitude = latitude,
          .height = height,
          .gravity = std::hypot(up_north, up) - kInteriorGradient * std::min(height, 0.0),
          .radius_north = prime_vertical * (1 - e2) / w2 + height,
          .radius_east = prime_vertical + height};
}

}  // namespace wellgyro
