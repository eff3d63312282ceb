#include "wellgyro/io/exchange/well_stations.h"

#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

bool TurnsBack(const SurveyPoint& a, const SurveyPoint& b) {
  // Cosine of 177.4 deg; no arc joins opposite directions, and no hole turns back within a leg.
  constexpr double kOpposite = -0.999;
  return Tangent(a.inclination, a.azimuth).dot(Tangent(b.inclination, b.azimuth)) < kOpposite;
}

// A survey without a unit of depth is read once more as metres: nothing else differs.
Result<SurveyTable> ParseInMetres(std::string_view text, const std::string& source,
                                  bool& unit_stated) {
  Result<SurveyTable> table = ParseSurvey(text, source);
  unit_stated = static_cast<bool>(table);
  if (table) return table;
  ReadOptions metres;
  metres.depth_unit = LengthUnit::kMetre;
  Result<SurveyTable> again = ParseSurvey(text, source, metres);
  return again || again.fault().code != FaultCode::kConflict ? again : table;
}

Column AzimuthColumn(const SurveyTable& table, North wanted) {
  if (table.head.azimuth.north == wanted) return Column::kAzimuth;
  const Column other = wanted == North::kGrid ? Column::kAzimuthGrid : Column::kAzimuthTrue;
  return table.Has(other) ? other : Column::kAzimuth;
}

void TakeStart(WellStations& well, const SurveyTable& table, std::size_t row) {
  const auto north = table.Get(Column::kNorth, row), east = table.Get(Column::kEast, row);
  const auto tvd = table.Get(Column::kTvd, row);
  well.start_stated = north && east && tvd;
  if (well.start_stated) well.start_W = {*north, *east, *tvd};
  if (north && east) well.offsets = Eigen::Vector2d(*north, *east);
  const auto northing = table.Get(Column::kNorthing, row),
             easting = table.Get(Column::kEasting, row);
  if (northing && easting) well.map = Eigen::Vector2d(*northing, *easting);
  well.datum_elevation = table.head.datum_elevation;
}

// Only convert has the options that a file may need.
Fault ForConvert(Fault fault) {
  if (fault.text.find(" --") != std::string::npos) {
    fault.text += "; that is an option of wellgyro convert, whose result can be taken here";
  }
  return fault;
}

std::optional<Fault> Fill(WellStations& well, const SurveyTable& table, const std::string& source,
                          North wanted) {
  const auto wrong = [&](FaultCode code, std::string text) {
    return Fault{.code = code, .text = std::move(text), .source = source};
  };
  const Column azimuth = AzimuthColumn(table, wanted);
  well.north = azimuth == Column::kAzimuth ? table.head.azimuth.north : wanted;
  if (well.north == North::kMagnetic) {
    return wrong(FaultCode::kForeign, "its azimuths are magnetic: wellgyro convert --north true");
  }
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.status(row) == RowStatus::kUnused) continue;
    const auto direction = table.Get(azimuth, row);
    if (!direction) {
      return wrong(FaultCode::kRange,
                   fmt::format("the station at MD {} m has no azimuth", table.md(row)));
    }
    SurveyPoint p;
    p.md = table.md(row);
    p.inclination = table.inclination(row);
    p.azimuth = WrapTwoPi(*direction);
    if (well.stations.empty()) {
      TakeStart(well, table, row);
    } else if (TurnsBack(well.stations.back(), p)) {
      return wrong(FaultCode::kRange,
                   fmt::format("at MD {} m the hole points back the way it came", p.md));
    }
    well.stations.push_back(p);
  }
  if (well.stations.size() < 2) {
    return wrong(FaultCode::kRange, "a survey needs at least two stations");
  }
  return std::nullopt;
}

}  // namespace

Result<WellStations> ParseWellStations(std::string_view text, const std::string& source,
                                       North wanted) {
  WellStations well;
  const Result<SurveyTable> table = ParseInMetres(text, source, well.depth_unit_stated);
  if (!table) return ForConvert(table.fault());
  if (auto fault = Fill(well, *table, source, wanted)) return *std::move(fault);
  return well;
}

std::optional<std::string> PlacesContradict(const WellStations& a, const WellStations& b) {
  if (!a.map || !b.map) return std::nullopt;
  const double by_map = (*a.map - *b.map).norm();
  const double by_offsets = (a.start_W - b.start_W).head<2>().norm();
  if (std::abs(by_map - by_offsets) <= 1 + 0.002 * by_map) return std::nullopt;
  return fmt::format("{:.1f} m apart by their map coordinates, {:.1f} m by north and east", by_map,
                     by_offsets);
}

}  // namespace wellgyro
