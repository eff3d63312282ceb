#include "wellgyro/io/exchange/told_options_internal.h"

#include <cmath>

#include <fmt/core.h>

#include "wellgyro/io/exchange/headings_internal.h"
#include "wellgyro/io/exchange/line_reader_internal.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"

namespace wellgyro {
namespace {

// What an option says holds against what the file says, with a note where they differ.
void TakeOver(SurveyHead& head, std::optional<double>& value, const std::optional<double>& option,
              std::string_view what) {
  if (!option) return;
  if (value && std::abs(*value - *option) > 1e-9) {
    head.notes.push_back(fmt::format("the {} is taken as told, not as the file says", what));
  }
  value = option;
}

void TakeOver(std::string& value, const std::string& option) {
  if (!option.empty()) value = option;
}

void TakeNorth(SurveyHead& head, North north, const Claims& claims) {
  const North said = head.azimuth.north;
  if (said != North::kUnknown && said != north) {
    head.notes.push_back(
        fmt::format("azimuths are taken from {} north as told, though the file "
                    "says {}",
                    WordOf(north), WordOf(said)));
  }
  head.azimuth.north = north;
  if (!claims.offsets_north) head.offsets = north;
}

// Formats that always say their unit of depth were read by it.
void TakeDepthUnit(SurveyTable& table, LengthUnit unit) {
  SurveyHead& head = table.head;
  if (head.md_unit == unit) return;
  head.notes.push_back(fmt::format("depths are taken in {} as told, though the file says {}",
                                   WordOf(unit), WordOf(head.md_unit)));
  const double factor = FactorOf(unit) / FactorOf(head.md_unit);
  for (const ColumnInfo& info : AllColumns()) {
    if (info.quantity != Quantity::kLength) continue;
    for (std::size_t row = 0; row < table.rows(); ++row) {
      if (const auto value = table.Get(info.column, row)) {
        table.Set(info.column, row, *value * factor);
      }
    }
  }
  head.md_unit = unit;
}

// TVD from another datum than MD, as a head says it, from that of MD.
void SettleTvdDatum(SurveyTable& table, const Claims& claims, const std::string& source) {
  SurveyHead& head = table.head;
  if (claims.tvd_datum.empty() || !table.Has(Column::kTvd)) return;
  if (!head.datum_elevation || !claims.tvd_elevation) {
    throw TextError{{.code = FaultCode::kConflict,
                     .text = fmt::format("TVD counts from {}, MD from {}: say --datum-elevation-m",
                                         claims.tvd_datum, head.datum),
                     .source = source}};
  }
  const double shift = *head.datum_elevation - *claims.tvd_elevation;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto tvd = table.Get(Column::kTvd, row);
    if (tvd) table.Set(Column::kTvd, row, *tvd + shift);
  }
  head.notes.push_back(
      fmt::format("TVD counts from {} in the file; here from {}, {:.2f} m above it",
                  claims.tvd_datum, head.datum, shift));
}

}  // namespace

void CheckColumns(const ReadOptions& options, const std::string& source) {
  for (const auto& [canonical, name] : options.columns) {
    const Heading want = HeadingOf(canonical);
    if (want.column || want.text || want.status || want.well) continue;
    throw TextError{{.code = FaultCode::kConflict,
                     .text = fmt::format("--columns {}={}: there is no {}; there are MD, INC, AZI, "
                                         "AZI_TRUE, AZI_GRID, AZI_MAG, TVD, TVDSS, N, E, NORTHING, "
                                         "EASTING, DLS and others of survey.csv",
                                         canonical, name, canonical),
                     .source = source}};
  }
}

void NoteUnused(SurveyTable& table, const ReadOptions& options, bool columns, bool trajectories) {
  if (!columns && !options.columns.empty()) {
    table.head.notes.emplace_back("--columns is not used: the format says what its columns are");
  }
  if (!trajectories && !options.trajectory.empty()) {
    table.head.notes.emplace_back("--trajectory is not used: the file has one survey");
  }
}

void TakeOptions(SurveyTable& table, const ReadOptions& options, const Claims& claims,
                 const std::string& source) {
  SurveyHead& head = table.head;
  if (options.north) TakeNorth(head, *options.north, claims);
  if (options.depth_unit) TakeDepthUnit(table, *options.depth_unit);
  TakeOver(head, head.azimuth.convergence, options.convergence, "convergence");
  TakeOver(head, head.azimuth.declination, options.declination, "declination");
  TakeOver(head, head.datum_elevation, options.datum_elevation, "elevation of the datum");
  TakeOver(head.azimuth.declination_source, options.declination_source);
  TakeOver(head.azimuth.declination_date, options.declination_date);
  TakeOver(head.datum, options.datum);
  if (options.latitude && options.longitude) {
    head.objects.insert(head.objects.begin(), {.number = static_cast<int>(head.objects.size()) + 1,
                                               .kind = "WRP",
                                               .name = head.names.well,
                                               .latitude_wgs84 = options.latitude,
                                               .longitude_wgs84 = options.longitude});
  }
  SettleTvdDatum(table, claims, source);
}

}  // namespace wellgyro
