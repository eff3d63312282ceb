#include "wellgyro/earth/crs.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/core.h>
#include <proj.h>

#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

constexpr char kWgs84[] = "EPSG:4326";

/// Carries a Fault to the door; never leaves this file.
struct CrsError {
  Fault fault;
};

[[noreturn]] void Refuse(FaultCode code, std::string text, const std::string& source) {
  Fault fault;
  fault.code = code;
  fault.text = std::move(text);
  fault.source = source;
  throw CrsError{std::move(fault)};
}

struct Deleter {
  void operator()(PJ_CONTEXT* p) const { proj_context_destroy(p); }
  void operator()(PJ* p) const { proj_destroy(p); }
  void operator()(PJ_OBJ_LIST* p) const { proj_list_destroy(p); }
  void operator()(PJ_OPERATION_FACTORY_CONTEXT* p) const {
    proj_operation_factory_context_destroy(p);
  }
};
template <class T>
using Held = std::unique_ptr<T, Deleter>;

/// One conversation with PROJ: nothing from a network, nothing on standard error.
class Session {
 public:
  Session() : context_(proj_context_create()) {
    proj_context_set_enable_network(context_.get(), 0);
    proj_log_level(context_.get(), PJ_LOG_NONE);
  }
  PJ_CONTEXT* get() const { return context_.get(); }

  /// Only authority and code: anything else could name a pipeline or a file.
  Held<PJ> System(const std::string& code) const {
    const std::size_t colon = code.find(':');
    const bool plain = colon != std::string::npos && colon > 0 && colon + 1 < code.size() &&
                       code.find_first_not_of(
                           "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                           "0123456789_:") == std::string::npos;
    Held<PJ> system(plain ? proj_create_from_database(context_.get(), code.substr(0, colon).c_str(),
                                                      code.substr(colon + 1).c_str(),
                                                      PJ_CATEGORY_CRS, 0, nullptr)
                          : nullptr);
    if (!system) {
      Refuse(FaultCode::kForeign, "no coordinate system has this code: write it as EPSG:23031",
             code);
    }
    return system;
  }

 private:
  Held<PJ_CONTEXT> context_;
};

bool IsGeographic(const PJ* system) {
  const PJ_TYPE type = proj_get_type(system);
  return type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
}

std::string MissingGrid(const Session& session, const PJ* operation) {
  const int grids = proj_coordoperation_get_grid_used_count(session.get(), operation);
  for (int i = 0; i < grids; ++i) {
    const char* name = nullptr;
    int available = 0;
    proj_coordoperation_get_grid_used(session.get(), operation, i, &name, nullptr, nullptr, nullptr,
                                      nullptr, nullptr, &available);
    if (!available && name) return name;
  }
  return {};
}

// A box of 0.1 m about longitude, latitude [deg], never across the antimeridian: before version 9.2
// PROJ takes a box without width for one that goes round the Earth, and then offers an operation of
// Denmark in Norway and none in New Zealand.
void SetPlace(PJ_CONTEXT* context, PJ_OPERATION_FACTORY_CONTEXT* factory, double longitude,
              double latitude) {
  constexpr double kHalf = 5e-7;  // [deg]
  const double lon = std::clamp(std::remainder(longitude, 360.0), -180 + kHalf, 180 - kHalf);
  const double lat = std::clamp(latitude, -90 + kHalf, 90 - kHalf);
  proj_operation_factory_context_set_area_of_interest(context, factory, lon - kHalf, lat - kHalf,
                                                      lon + kHalf, lat + kHalf);
}

/// The best operation at longitude, latitude [deg], for x east and y north; as if every grid were
/// here, so that a missing one is noticed.
Held<PJ> Best(const Session& session, const PJ* from, const PJ* to, const std::string& names,
              std::optional<std::pair<double, double>> at) {
  const Held<PJ_OPERATION_FACTORY_CONTEXT> factory(
      proj_create_operation_factory_context(session.get(), nullptr));
  PJ_CONTEXT* const c = session.get();
  proj_operation_factory_context_set_allow_ballpark_transformations(c, factory.get(), 0);
  proj_operation_factory_context_set_grid_availability_use(c, factory.get(),
                                                           PROJ_GRID_AVAILABILITY_IGNORED);
  proj_operation_factory_context_set_spatial_criterion(c, factory.get(),
                                                       PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
  if (at) SetPlace(c, factory.get(), at->first, at->second);
  const Held<PJ_OBJ_LIST> list(proj_create_operations(c, from, to, factory.get()));
  if (!list || proj_list_get_count(list.get()) == 0) {
    Refuse(FaultCode::kRange,
           "the registry has no operation between these datums at this place: is it the right one, "
           "the easting before the northing, in the system's own unit?",
           names);
  }
  Held<PJ> best(proj_list_get(c, list.get(), 0));
  if (const std::string grid = MissingGrid(session, best.get()); !grid.empty()) {
    Refuse(FaultCode::kRange,
           fmt::format("the best operation, {1}, needs the grid file {0}, which this machine "
                       "lacks: put it into PROJ's folder of grids, as by projsync --file {0}",
                       grid, proj_get_name(best.get())),
           names);
  }
  Held<PJ> normal(proj_normalize_for_visualization(c, best.get()));
  if (!normal) Refuse(FaultCode::kRange, "the operation cannot be carried out", names);
  return normal;
}

CrsPoint Apply(const PJ* operation, PJ_DIRECTION direction, const CrsPoint& point,
               const std::string& names) {
  PJ* const p = const_cast<PJ*>(operation);  // PROJ keeps its last error there
  proj_errno_reset(p);
  const PJ_COORD out = proj_trans(p, direction, proj_coord(point.x, point.y, point.z, 0));
  if (proj_errno(p) != 0 || !std::isfinite(out.xyz.x) || !std::isfinite(out.xyz.y)) {
    Refuse(FaultCode::kRange, "the point is outside the system", names);
  }
  return {out.xyz.x, out.xyz.y, out.xyz.z};
}

/// From a projected system to longitude and latitude [deg] on its own datum.
Held<PJ> ToOwnGeographic(const Session& session, const PJ* system, const std::string& name) {
  const Held<PJ> base(proj_crs_get_geodetic_crs(session.get(), system));
  if (!base) Refuse(FaultCode::kForeign, "has no geographic system of its own", name);
  return Best(session, system, base.get(), name, std::nullopt);
}

CrsPoint OwnGeographic(const Session& session, const PJ* system, const CrsPoint& point,
                       const std::string& name) {
  if (IsGeographic(system)) return point;
  return Apply(ToOwnGeographic(session, system, name).get(), PJ_FWD, point, name);
}

ShiftedPoint Shift(const Session& session, const std::string& from, const std::string& to,
                   const CrsPoint& point) {
  if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) {
    Refuse(FaultCode::kRange, "the point is not finite", from);
  }
  const Held<PJ> source = session.System(from), target = session.System(to);
  const std::string names = from + " to " + to;
  const CrsPoint rough = OwnGeographic(session, source.get(), point, from);
  const Held<PJ> best =
      Best(session, source.get(), target.get(), names, std::pair(rough.x, rough.y));
  ShiftedPoint shifted;
  shifted.point = Apply(best.get(), PJ_FWD, point, names);
  const char* const name = proj_get_name(best.get());
  shifted.operation = name ? name : "";
  const double accuracy = proj_coordoperation_get_accuracy(session.get(), best.get());
  if (accuracy >= 0) shifted.accuracy = accuracy;
  return shifted;
}

void ReadUnit(const Session& session, const PJ* system, CrsGridPoint& made) {
  const Held<PJ> axes(proj_crs_get_coordinate_system(session.get(), system));
  const char* name = nullptr;
  double factor = 1;
  if (axes && proj_cs_get_axis_info(session.get(), axes.get(), 0, nullptr, nullptr, nullptr,
                                    &factor, &name, nullptr, nullptr)) {
    made.unit = factor;
    made.unit_name = name ? name : "";
  }
}

// The name of the area that the registry states for the system, where the place is not in it.
std::string OutsideOf(const Session& session, const PJ* system, const CrsPoint& own) {
  double west = 0, south = 0, east = 0, north = 0;
  const char* name = nullptr;
  constexpr double kUnknown = -1000;  // PROJ's
  if (!proj_get_area_of_use(session.get(), system, &west, &south, &east, &north, &name) ||
      west == kUnknown) {
    return {};
  }
  const double lon = std::remainder(own.x, 360.0);
  const bool along = west <= east ? lon >= west && lon <= east : lon >= west || lon <= east;
  if (along && own.y >= south && own.y <= north) return {};
  return name ? name : "that the registry states";
}

// Convergence and scale by central differences of the projection, which rounding and the third
// derivative leave good to 1e-8: proj_factors of PROJ 9.1 takes the first axis for the easting even
// where it is the northing.
void Differentiate(const Session& session, const PJ* system, const CrsPoint& own,
                   const std::string& code, CrsGridPoint& made) {
  // [deg], h = 1.7e-5 rad, 110 m: h^2 / 6 = 5e-11 of truncation, 1 nm of rounding over 220 m 5e-12.
  constexpr double kStep = 1e-3;
  const Held<PJ> back = ToOwnGeographic(session, system, code);
  const auto slope = [&](double dx, double dy) {
    const CrsPoint a = Apply(back.get(), PJ_INV, {own.x - dx, own.y - dy, 0}, code);
    const CrsPoint b = Apply(back.get(), PJ_INV, {own.x + dx, own.y + dy, 0}, code);
    const double by = made.unit / (2 * kStep * units::kDeg);
    return std::pair((b.x - a.x) * by, (b.y - a.y) * by);
  };
  const auto [east_by_lat, north_by_lat] = slope(0, kStep);
  const auto [east_by_lon, north_by_lon] = slope(kStep, 0);
  const Held<PJ> ellipsoid(proj_get_ellipsoid(session.get(), system));
  double semi_major = 0, semi_minor = 0;
  if (!ellipsoid || !proj_ellipsoid_get_parameters(session.get(), ellipsoid.get(), &semi_major,
                                                   &semi_minor, nullptr, nullptr)) {
    Refuse(FaultCode::kForeign, "has no ellipsoid", code);
  }
  const double e2 = 1 - semi_minor * semi_minor / (semi_major * semi_major);
  const double sine = std::sin(own.y * units::kDeg), cosine = std::cos(own.y * units::kDeg);
  const double w2 = 1 - e2 * sine * sine;
  // Area on the ellipsoid by latitude and longitude.
  const double area = semi_major * semi_major * (1 - e2) * cosine / (w2 * w2);
  const double mapped = std::abs(east_by_lon * north_by_lat - north_by_lon * east_by_lat);
  if (!(area > 0) || !(mapped > 0)) {
    Refuse(FaultCode::kRange, "the projection has no convergence here", code);
  }
  made.point.convergence = -std::atan2(east_by_lat, north_by_lat);
  made.point.scale = std::sqrt(mapped / area);
}

CrsGridPoint Project(const std::string& code, const GeodeticPoint& place) {
  const Session session;
  const Held<PJ> system = session.System(code);
  if (proj_get_type(system.get()) != PJ_TYPE_PROJECTED_CRS) {
    Refuse(FaultCode::kForeign, "is no projected system: it has no grid north", code);
  }
  const CrsPoint wgs{place.longitude / units::kDeg, place.latitude / units::kDeg, 0};
  const ShiftedPoint shifted = Shift(session, kWgs84, code, wgs);
  const CrsPoint& grid = shifted.point;
  const CrsPoint own = OwnGeographic(session, system.get(), grid, code);
  CrsGridPoint made;
  made.name = proj_get_name(system.get());
  ReadUnit(session, system.get(), made);
  made.point.easting = grid.x * made.unit;
  made.point.northing = grid.y * made.unit;
  made.geographic = {own.y * units::kDeg, own.x * units::kDeg};
  made.operation = shifted.operation;
  made.accuracy = shifted.accuracy;
  made.outside = OutsideOf(session, system.get(), own);
  Differentiate(session, system.get(), own, code, made);
  return made;
}

}  // namespace

Result<ShiftedPoint> ShiftPoint(const std::string& from, const std::string& to,
                                const CrsPoint& point) {
  try {
    const Session session;
    return Shift(session, from, to, point);
  } catch (const CrsError& error) {
    return error.fault;
  }
}

Result<CrsGridPoint> ProjectToCrs(const std::string& system, const GeodeticPoint& place) {
  try {
    return Project(system, place);
  } catch (const CrsError& error) {
    return error.fault;
  }
}

Result<GeodeticPoint> GeodeticOfCrs(const std::string& system, const CrsPoint& point) {
  const auto shifted = ShiftPoint(system, kWgs84, point);
  if (!shifted) return shifted.fault();
  return GeodeticPoint{shifted->point.y * units::kDeg, shifted->point.x * units::kDeg};
}

}  // namespace wellgyro
