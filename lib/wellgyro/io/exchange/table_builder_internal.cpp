#include "wellgyro/io/exchange/table_builder_internal.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/exchange/column_units_internal.h"

namespace wellgyro {
namespace {

// Of one survey, 1 GiB of numbers and of text each: beyond any hole's, below what ends a program.
constexpr std::size_t kMostCells = std::size_t{1} << 27;
constexpr std::size_t kMostTextBytes = std::size_t{1} << 30;

// The nearest row of the path with an azimuth of its own, in either direction.
std::optional<std::size_t> Nearest(const SurveyTable& table,
                                   const std::vector<std::size_t>& without, std::size_t row,
                                   int step) {
  const auto rows = static_cast<std::ptrdiff_t>(table.rows());
  for (auto i = static_cast<std::ptrdiff_t>(row) + step; i >= 0 && i < rows; i += step) {
    const auto k = static_cast<std::size_t>(i);
    if (OnPath(table.status(k)) && !std::binary_search(without.begin(), without.end(), k)) return k;
  }
  return std::nullopt;
}

}  // namespace

std::string RowsText(const SurveyTable& table, const std::vector<std::size_t>& rows) {
  const double first = table.md(rows.front()), last = table.md(rows.back());
  if (rows.size() == 1) return fmt::format("MD {:.2f} m", first);
  return fmt::format("{} stations from MD {:.2f} m to {:.2f} m", rows.size(), std::min(first, last),
                     std::max(first, last));
}

bool StandsForNothing(double number) {
  for (const double nothing : {-999.25, -9999.0, -999.0, -9999.25, -99999.0, -99999.25, -999.99,
                               -9999.99, -999999.0, -999999.25, -32768.0, -32767.0}) {
    if (number == nothing) return true;
  }
  return number <= -1e30 || number >= 1e30;
}

std::optional<double> InclinationOf(double number, double factor) {
  if (StandsForNothing(number)) return std::nullopt;
  return number * factor;
}

std::optional<double> AzimuthOf(double number, double factor) {
  const double azimuth = ValueOf(Quantity::kDirection, number, factor);
  const bool outside = std::abs(number * factor) > kTwoPi * (1 + 1e-12);
  return outside ? std::nullopt : std::optional(azimuth);
}

std::optional<TableBuilder::Problem> TableBuilder::Bounds(double md, double inclination) const {
  if (!(inclination >= 0 && inclination <= kPi * (1 + 1e-12))) {
    return Problem{FaultCode::kRange,
                   fmt::format("{} deg is no inclination", Exact(inclination, FromDegrees(1)))};
  }
  constexpr double kDeepest = 1e6;  // [m]; no hole is
  if (!(std::abs(md) <= kDeepest)) {
    return Problem{FaultCode::kRange, fmt::format("{} m is no measured depth", Exact(md, 1))};
  }
  return std::nullopt;
}

std::optional<TableBuilder::Problem> TableBuilder::Order(double md, double inclination,
                                                         std::optional<double> azimuth) {
  if (last_md_) {
    const bool same = md == *last_md_ && inclination == last_inclination_ &&
                      (azimuth == last_azimuth_ || inclination == 0);
    if (same) {
      left_out_ = true;
      ++repeated_;
      return std::nullopt;
    }
    if (direction_ == 0 && md != *last_md_) direction_ = md > *last_md_ ? 1 : -1;
    if (!(direction_ * (md - *last_md_) > 0)) {
      return Problem{FaultCode::kOrder,
                     fmt::format("depth {} m after {} m: depth must {}", Exact(md),
                                 Exact(*last_md_), direction_ < 0 ? "go on falling" : "increase")};
    }
  }
  last_md_ = md;
  last_inclination_ = inclination;
  last_azimuth_ = azimuth;
  return std::nullopt;
}

std::optional<TableBuilder::Problem> TableBuilder::Add(double md, std::optional<double> inclination,
                                                       std::optional<double> azimuth,
                                                       RowStatus status) {
  left_out_ = !inclination;
  if (!inclination) {
    ++without_inclination_;
    return std::nullopt;
  }
  if (auto problem = Bounds(md, *inclination)) return problem;
  if (OnPath(status)) {
    if (auto problem = Order(md, *inclination, azimuth)) return problem;
    if (left_out_) return std::nullopt;
  }
  if (table.rows() % 1024 == 0 && table.cells() > kMostCells) {
    return Problem{FaultCode::kSize, "more numbers than a survey can have here: split the file"};
  }
  if (text_bytes_ > kMostTextBytes) {
    return Problem{FaultCode::kSize, "more text than a survey can have here: split the file"};
  }
  const std::size_t row = table.Add(md, *inclination, azimuth.value_or(0), status);
  if (!azimuth) without_azimuth_.push_back(row);
  return std::nullopt;
}

void TableBuilder::Set(Column column, double value) {
  if (!left_out_) table.Set(column, table.rows() - 1, value);
}

void TableBuilder::Set(TextColumn column, std::string text) {
  if (left_out_) return;
  text_bytes_ += text.size();
  table.Set(column, table.rows() - 1, std::move(text));
}

void TableBuilder::SetStatus(RowStatus status) {
  if (!left_out_) table.SetStatus(table.rows() - 1, status);
}

void TableBuilder::FillAzimuth(std::size_t row) {
  constexpr double kNoAzimuth = FromDegrees(0.05);  // what files of one decimal round to vertical
  const auto above = Nearest(table, without_azimuth_, row, -1);
  const auto below = Nearest(table, without_azimuth_, row, 1);
  if (table.inclination(row) <= kNoAzimuth) {
    const auto neighbour = above ? above : below;
    if (neighbour) table.Set(Column::kAzimuth, row, table.azimuth(*neighbour));
    return;
  }
  double azimuth = table.azimuth(above ? *above : *below);
  if (above && below) {
    const double part = (table.md(row) - table.md(*above)) / (table.md(*below) - table.md(*above));
    azimuth += part * WrapPi(table.azimuth(*below) - azimuth);
  }
  table.Set(Column::kAzimuth, row, WrapTwoPi(azimuth));
  table.SetStatus(row, RowStatus::kAzimuthInterpolated);
}

void TableBuilder::FillAzimuths() {
  std::vector<std::size_t> vertical, tilted;
  for (const std::size_t row : without_azimuth_) {
    FillAzimuth(row);
    const bool filled = table.status(row) == RowStatus::kAzimuthInterpolated;
    (filled ? tilted : vertical).push_back(row);
  }
  std::vector<std::string>& notes = table.head.notes;
  if (!vertical.empty()) {
    notes.push_back("no azimuth at " + RowsText(table, vertical) + ", where the hole is vertical");
  }
  if (!tilted.empty()) {
    notes.push_back("no azimuth at " + RowsText(table, tilted) + ": interpolated");
  }
}

std::optional<TableBuilder::Problem> TableBuilder::Finish() {
  std::vector<std::string>& notes = table.head.notes;
  if (without_inclination_ > 0) {
    notes.push_back(fmt::format("{} rows without inclination are left out", without_inclination_));
  }
  if (repeated_ > 0) {
    notes.push_back(repeated_ == 1 ? std::string("a row is there twice")
                                   : fmt::format("{} rows are there twice", repeated_));
  }
  if (!without_azimuth_.empty()) {
    const bool none = without_azimuth_.size() == table.rows();
    const bool tilted = std::any_of(without_azimuth_.begin(), without_azimuth_.end(),
                                    [&](std::size_t row) { return table.inclination(row) > 0; });
    if (none && tilted) return Problem{FaultCode::kForeign, "not a single azimuth"};
    FillAzimuths();
  }
  if (direction_ < 0) {
    table.Reverse();
    notes.emplace_back("its stations go from the bottom up: turned round");
  }
  return std::nullopt;
}

}  // namespace wellgyro
