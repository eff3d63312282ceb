#include "wellgyro/earth/grid.h"

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <GeographicLib/Constants.hpp>
#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/LambertConformalConic.hpp>
#include <GeographicLib/PolarStereographic.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

constexpr double kTransverseMercatorReach = FromDegrees(35);  // good to 5 nm so far [rad]
constexpr double kFarthest = 1e8;  // beyond it a cone's or plane's far pole is near [m]

double Flattening(const GridSpec& grid) {
  return grid.inverse_flattening == 0 ? 0 : 1 / grid.inverse_flattening;
}

// What a projection of GeographicLib's gives, northing counted from the latitude of origin.
template <class Projection>
GridPoint FromOrigin(const Projection& projection, const GridSpec& grid, double latitude,
                     double longitude) {
  const double meridian = ToDegrees(grid.longitude_origin);
  double unused = 0, northing_origin = 0, convergence_deg = 0;
  projection.Forward(meridian, ToDegrees(grid.latitude_origin), meridian, unused, northing_origin);
  GridPoint point;
  projection.Forward(meridian, ToDegrees(latitude), ToDegrees(longitude), point.easting,
                     point.northing, convergence_deg, point.scale);
  point.northing -= northing_origin;
  point.convergence = FromDegrees(convergence_deg);
  return point;
}

// What the projection gives before false easting and northing; convergence in radians.
GridPoint TransverseMercator(const GridSpec& grid, double latitude, double longitude) {
  if (!(std::abs(WrapPi(longitude - grid.longitude_origin)) <= kTransverseMercatorReach)) {
    throw std::domain_error(
        fmt::format("ProjectToGrid: longitude {} deg is too far from the central meridian {} deg",
                    ToDegrees(longitude), ToDegrees(grid.longitude_origin)));
  }
  const GeographicLib::TransverseMercator projection(grid.semi_major, Flattening(grid),
                                                     grid.scale_origin);
  return FromOrigin(projection, grid, latitude, longitude);
}

GridPoint LambertCone(const GridSpec& grid, double latitude, double longitude) {
  const GeographicLib::LambertConformalConic projection(
      grid.semi_major, Flattening(grid), ToDegrees(grid.parallel_1), ToDegrees(grid.parallel_2),
      grid.scale_origin);
  return FromOrigin(projection, grid, latitude, longitude);
}

GridPoint PolarPlane(const GridSpec& grid, double latitude, double longitude) {
  const GeographicLib::PolarStereographic projection(grid.semi_major, Flattening(grid),
                                                     grid.scale_origin);
  GridPoint point;
  double convergence_deg = 0;
  projection.Forward(grid.north_pole, ToDegrees(latitude),
                     ToDegrees(WrapPi(longitude - grid.longitude_origin)), point.easting,
                     point.northing, convergence_deg, point.scale);
  point.convergence = FromDegrees(convergence_deg);
  return point;
}

void CheckOrigin(const GridSpec& grid) {
  for (const auto& [name, value] : {std::pair{"false_easting", grid.false_easting},
                                    {"false_northing", grid.false_northing},
                                    {"latitude_origin", grid.latitude_origin},
                                    {"longitude_origin", grid.longitude_origin}}) {
    if (std::isfinite(value)) continue;
    throw std::invalid_argument(
        fmt::format("ProjectToGrid: grid '{}': {} = {} is not finite", grid.name, name, value));
  }
}

GridPoint Project(const GridSpec& grid, double latitude, double longitude) {
  switch (grid.projection) {
    case GridSpec::Projection::kTransverseMercator:
      return TransverseMercator(grid, latitude, longitude);
    case GridSpec::Projection::kLambertConformalConic:
      return LambertCone(grid, latitude, longitude);
    case GridSpec::Projection::kPolarStereographic:
      return PolarPlane(grid, latitude, longitude);
  }
  throw std::invalid_argument("ProjectToGrid: no such projection");
}

}  // namespace

GridSpec UtmGrid(const std::string& zone) {
  int number = 0;
  const char* const end = zone.data() + zone.size();
  const auto [rest, error] = std::from_chars(zone.data(), end, number);
  const bool letter = rest != end && rest + 1 == end && (*rest == 'N' || *rest == 'S');
  if (error != std::errc() || !letter || number < 1 || number > 60) {
    throw std::invalid_argument(fmt::format(
        "'{}' is no UTM zone: write the zone 1 to 60 and the hemisphere N or S, as 31N", zone));
  }
  GridSpec grid;
  grid.name = fmt::format("UTM {}{}", number, *rest);
  grid.longitude_origin = FromDegrees(6 * number - 183);
  grid.scale_origin = 0.9996;
  grid.false_easting = 500'000;
  grid.false_northing = *rest == 'N' ? 0 : 10'000'000;
  return grid;
}

GridPoint ProjectToGrid(const GridSpec& grid, double latitude, double longitude) {
  if (!(std::abs(latitude) <= kPi / 2) || !std::isfinite(longitude)) {
    throw std::domain_error(fmt::format("ProjectToGrid: {} deg, {} deg is no place on the Earth",
                                        ToDegrees(latitude), ToDegrees(longitude)));
  }
  CheckOrigin(grid);
  GridPoint point;
  try {
    point = Project(grid, latitude, longitude);
  } catch (const GeographicLib::GeographicErr& error) {
    throw std::invalid_argument(
        fmt::format("ProjectToGrid: grid '{}': {}", grid.name, error.what()));
  }
  if (!(std::hypot(point.easting, point.northing) < kFarthest) || !(point.scale > 0)) {
    throw std::domain_error(
        fmt::format("ProjectToGrid: {} deg, {} deg lies outside the projection '{}'",
                    ToDegrees(latitude), ToDegrees(longitude), grid.name));
  }
  point.easting += grid.false_easting;
  point.northing += grid.false_northing;
  return point;
}

GeodeticPoint OffsetGeodetic(GeodeticPoint head, double north, double east) {
  double latitude = 0, longitude = 0;
  GeographicLib::Geodesic::WGS84().Direct(ToDegrees(head.latitude), ToDegrees(head.longitude),
                                          ToDegrees(std::atan2(east, north)),
                                          std::hypot(north, east), latitude, longitude);
  return {.latitude = FromDegrees(latitude), .longitude = FromDegrees(longitude)};
}

WellGrid::WellGrid(const GridSpec& grid, GeodeticPoint head)
    : grid_(grid),
      head_(head),
      projected_head_(ProjectToGrid(grid, head.latitude, head.longitude)) {
  if (grid.scale && !(*grid.scale > 0 && std::isfinite(*grid.scale))) {
    throw std::invalid_argument(fmt::format("WellGrid: stated scale {}", *grid.scale));
  }
  if (grid.convergence && !std::isfinite(*grid.convergence)) {
    throw std::invalid_argument("WellGrid: stated convergence is not finite");
  }
}

GridPoint WellGrid::At(double north, double east) const {
  const GeodeticPoint place = OffsetGeodetic(head_, north, east);
  GridPoint point = ProjectToGrid(grid_, place.latitude, place.longitude);
  const double turn =
      grid_.convergence.value_or(projected_head_.convergence) - projected_head_.convergence;
  const double stretch = grid_.scale.value_or(projected_head_.scale) / projected_head_.scale;
  const double dn = point.northing - projected_head_.northing;
  const double de = point.easting - projected_head_.easting;
  // More convergence means a smaller grid azimuth.
  const double c = std::cos(turn), s = std::sin(turn);
  point.northing = projected_head_.northing + stretch * (c * dn + s * de);
  point.easting = projected_head_.easting + stretch * (c * de - s * dn);
  point.convergence += turn;
  point.scale *= stretch;
  return point;
}

}  // namespace wellgyro
