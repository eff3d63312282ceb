#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/io/exchange/certificate_internal.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

std::string CsvName(const ColumnInfo& info, const SurveyHead& head) {
  const auto by_north = [](std::string_view name, North north) {
    switch (north) {
      case North::kTrue:
        return std::string(name) + "_TRUE";
      case North::kGrid:
        return std::string(name) + "_GRID";
      default:
        return std::string(name) + "_MAG";
    }
  };
  if (info.column == Column::kAzimuth) return by_north("AZI", head.azimuth.north);
  const bool offset = info.column == Column::kNorth || info.column == Column::kEast;
  if (offset && head.offsets != head.azimuth.north && head.offsets != North::kUnknown) {
    return by_north(info.csv, head.offsets);
  }
  return std::string(info.csv);
}

// survey.csv's order first, so that a survey of ours comes out as one.
std::vector<Column> CsvOrder(const SurveyTable& table) {
  constexpr std::array kFirst{Column::kMd,          Column::kInclination, Column::kAzimuth,
                              Column::kToolface,    Column::kTvd,         Column::kNorth,
                              Column::kEast,        Column::kDogleg,      Column::kVarNN,
                              Column::kCovNE,       Column::kCovNV,       Column::kVarEE,
                              Column::kCovEV,       Column::kVarVV,       Column::kSigmaInclination,
                              Column::kSigmaAzimuth};
  std::vector<Column> order(kFirst.begin(), kFirst.end());
  for (const ColumnInfo& info : AllColumns()) {
    if (std::find(order.begin(), order.end(), info.column) == order.end()) {
      order.push_back(info.column);
    }
  }
  std::erase_if(order, [&](Column c) { return !table.Has(c); });
  return order;
}

std::string Preamble(const SurveyHead& head) {
  std::string text;
  for (const auto& [key, value] : PairsOf(head)) {
    std::string line = fmt::format("# {}: {}", key, value);
    std::replace(line.begin(), line.end(), '\n', ' ');
    text += line + "\n";
  }
  return text;
}

bool NeedsStatus(const SurveyTable& table) {
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.status(row) != RowStatus::kSurveyed) return true;
  }
  return false;
}

std::string HeadingLine(const SurveyTable& table, const std::vector<Column>& columns) {
  std::string line;
  for (const Column column : columns) {
    const ColumnInfo& info = InfoOf(column);
    const std::string unit = UnitOf(info.quantity, table.head);
    line += (line.empty() ? "" : ",") + CsvName(info, table.head) +
            (unit.empty() ? "" : "[" + unit + "]");
  }
  for (const TextColumnInfo& info : AllTextColumns()) {
    if (table.Has(info.column)) line += "," + std::string(info.csv);
  }
  return line;
}

void AppendRow(const SurveyTable& table, const std::vector<Column>& columns, std::size_t row,
               std::string& text) {
  bool first = true;
  for (const Column column : columns) {
    if (!first) text += ',';
    first = false;
    if (const auto value = table.Get(column, row)) {
      text += Exact(InfoOf(column).quantity, *value, table.head);
    }
  }
  for (const TextColumnInfo& info : AllTextColumns()) {
    if (table.Has(info.column)) text += "," + CsvQuoted(table.Get(info.column, row));
  }
}

}  // namespace

std::string WriteCsv(const SurveyTable& table, const WriteOptions& options) {
  NeedNorth(table, "CSV");
  const std::vector<Column> columns = CsvOrder(table);
  const bool status = NeedsStatus(table);
  std::string text = options.preamble ? Preamble(table.head) : "";
  text += HeadingLine(table, columns) + (status ? ",STATUS\n" : "\n");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    AppendRow(table, columns, row, text);
    if (status) text += "," + std::string(WordOf(table.status(row)));
    text += '\n';
  }
  // An empty line ends the table: without it a cut between two rows could not be seen.
  text += '\n';
  if (!options.preamble) return text;
  return "# " + CertificateText(table.rows(), text) + "\n" + text;
}

}  // namespace wellgyro
