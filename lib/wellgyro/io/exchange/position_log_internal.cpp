#include "wellgyro/io/exchange/position_log_internal.h"

#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/median.h"

namespace wellgyro {
namespace {

std::optional<Eigen::Vector3d> PlaceOf(const SurveyTable& table, std::size_t row, bool map) {
  const auto n = table.Get(map ? Column::kNorthing : Column::kNorth, row);
  const auto e = table.Get(map ? Column::kEasting : Column::kEast, row);
  for (const Column depth : {Column::kTvd, Column::kDown, Column::kTvdSubSea}) {
    const auto d = table.Get(depth, row);
    if (n && e && d) return Eigen::Vector3d(*n, *e, *d);
  }
  return std::nullopt;
}

// A depth that falls along the hole is a height.
void TurnHeights(SurveyTable& table, Column column) {
  if (!table.Has(column)) return;
  const auto first = table.Get(column, 0), last = table.Get(column, table.rows() - 1);
  if (!first || !last || *last >= *first) return;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (const auto value = table.Get(column, row)) table.Set(column, row, -*value);
  }
  table.head.notes.emplace_back("Z falls along the hole: it is taken for a height");
}

}  // namespace

std::optional<std::string> BackCalculate(SurveyTable& table) {
  if (table.rows() < 2) return "a position log needs two stations";
  TurnHeights(table, Column::kDown);
  TurnHeights(table, Column::kTvdSubSea);
  const bool map = !table.Has(Column::kNorth);
  std::vector<double> stretched;
  for (std::size_t row = 1; row < table.rows(); ++row) {
    const auto a = PlaceOf(table, row - 1, map), b = PlaceOf(table, row, map);
    if (!a || !b) return fmt::format("no position at MD {:.2f} m", table.md(row));
    const Eigen::Vector3d chord = *b - *a;
    stretched.push_back(chord.norm() / (table.md(row) - table.md(row - 1)));
    const double across = std::hypot(chord.x(), chord.y());
    const double inclination = std::atan2(across, chord.z());
    const double azimuth = across > 0 ? WrapTwoPi(std::atan2(chord.y(), chord.x())) : 0;
    for (const std::size_t to : {row, row - 1}) {
      if (to == row - 1 && row > 1) continue;
      table.Set(Column::kInclination, to, inclination);
      table.Set(Column::kAzimuth, to, azimuth);
      table.SetStatus(to, RowStatus::kBackCalculated);
    }
  }
  const double typical = Median(std::move(stretched));
  if (typical > 1.002 || typical < 0.5) {
    return fmt::format(
        "positions move {:.4g} times as far as measured depth: one of them is in "
        "another unit or column; say --depth-unit, or the column by --columns",
        typical);
  }
  if (map) {
    table.head.azimuth.north = North::kGrid;
  } else if (table.head.offsets != North::kUnknown) {
    table.head.azimuth.north = table.head.offsets;
  }
  table.head.notes.emplace_back(
      "a position log: its angles are computed from its positions, and nothing checks them");
  return std::nullopt;
}

}  // namespace wellgyro
