#include "wellgyro/io/exchange/witsml_row_internal.h"

#include <algorithm>
#include <charconv>

#include <fmt/core.h>

#include "wellgyro/io/exchange/columns_internal.h"
#include "wellgyro/io/exchange/headings_internal.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/exchange/witsml_text_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro::witsml {
namespace {

std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '%' || c == ';' || c == '=') {
      escaped += fmt::format("%{:02X}", static_cast<unsigned>(c));
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string Unescaped(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned code = 0;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(text.data() + i + 1, text.data() + i + 3, code, 16).ptr ==
            text.data() + i + 3) {
      plain += static_cast<char>(code);
      i += 2;
    } else {
      plain += text[i];
    }
  }
  return plain;
}

void TakeNumber(const Heading& heading, std::string_view text, SurveyTable& table,
                std::size_t row) {
  const Quantity quantity = InfoOf(*heading.column).quantity;
  const auto factor = FactorOf(quantity, heading.unit);
  const auto number = NumberOf(text);
  if (!factor || !number) return;
  if (quantity == Quantity::kGridLength) {
    if (const auto unit = LengthUnitOf(heading.unit)) table.head.grid_unit = *unit;
  }
  table.Set(*heading.column, row, ValueOf(quantity, *number, *factor));
}

// Only names that PackedRow writes: an alias could mean another column.
std::optional<Column> ColumnOf(std::string_view name) {
  for (const ColumnInfo& info : AllColumns()) {
    if (info.csv == name) return info.column;
  }
  return std::nullopt;
}

}  // namespace

std::string PackedRow(const SurveyTable& table, std::size_t row,
                      const std::vector<Column>& native) {
  std::string packed;
  const auto add = [&](const std::string& entry) {
    if (packed.size() + 1 + entry.size() > kValueLengthOf21) return;
    packed += (packed.empty() ? "" : ";") + entry;
  };
  for (const ColumnInfo& info : AllColumns()) {
    const auto value = table.Get(info.column, row);
    if (!value || std::find(native.begin(), native.end(), info.column) != native.end()) continue;
    const std::string unit = UnitOf(info.quantity, table.head);
    add(fmt::format("{}{}={}", info.csv, unit.empty() ? "" : "[" + unit + "]",
                    Exact(info.quantity, *value, table.head)));
  }
  const RowStatus status = table.status(row);
  if (status != RowStatus::kSurveyed && status != RowStatus::kTieIn &&
      status != RowStatus::kUnused) {
    add(fmt::format("STATUS={}", WordOf(status)));
  }
  for (const TextColumnInfo& info : AllTextColumns()) {
    const std::string& text = table.Get(info.column, row);
    if (text.empty() || info.column == TextColumn::kUid || info.column == TextColumn::kErrorModel) {
      continue;
    }
    add(fmt::format("{}={}", info.csv, Escaped(text)));
  }
  return packed;
}

void UnpackRow(std::string_view text, SurveyTable& table, std::size_t row) {
  std::vector<std::string_view> entries;
  Split(text, ';', entries);
  for (const std::string_view entry : entries) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string_view::npos) continue;
    const std::string_view key = entry.substr(0, equals), value = entry.substr(equals + 1);
    if (key == "STATUS") {
      if (const auto status = RowStatusOf(value)) table.SetStatus(row, *status);
      continue;
    }
    for (const TextColumnInfo& info : AllTextColumns()) {
      if (info.csv == key) table.Set(info.column, row, Unescaped(value));
    }
    Heading heading = HeadingOf(key);
    heading.column = ColumnOf(Trim(key.substr(0, key.find('['))));
    if (heading.column) TakeNumber(heading, value, table, row);
  }
}

}  // namespace wellgyro::witsml
