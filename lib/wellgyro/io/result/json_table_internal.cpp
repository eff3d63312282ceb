#include "wellgyro/io/result/json_table_internal.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

// Columns whose cells are words even where they look like numbers, as the unit 1.
constexpr std::array<std::string_view, 12> kWordColumns = {
    "KIND",         "QUALITY", "PASS",  "STATUS", "CODE",      "UNIT",
    "LIMIT_SOURCE", "VERDICT", "ALIKE", "REMEDY", "BEGIN_UTC", "WELL"};

bool IsWords(std::string_view column) {
  return std::find(kWordColumns.begin(), kWordColumns.end(), column) != kWordColumns.end();
}

/// The next record of `text`, which may go over several lines within quotes; moves `line` on.
std::optional<std::vector<std::string>> NextRecord(std::string_view& text, int& line) {
  std::size_t end = 0;
  bool open = false;
  for (; end < text.size() && (open || text[end] != '\n'); ++end) {
    if (text[end] == '"') open = !open;
    if (text[end] == '\n') ++line;
  }
  ++line;
  std::string_view record = text.substr(0, end);
  if (record.ends_with('\r')) record.remove_suffix(1);
  text.remove_prefix(std::min(end + 1, text.size()));
  return SplitQuoted(record, ',');
}

Json CellOf(const std::string& cell, bool words) {
  if (cell.empty()) return nullptr;
  if (words) return cell;
  const std::optional<double> number = NumberOf(cell);
  return number ? Json(*number) : Json(cell);
}

Fault Unreadable(std::string text, const std::string& source, int line) {
  return {.code = FaultCode::kSyntax, .text = std::move(text), .source = source, .line = line};
}

}  // namespace

Result<Json> JsonTable(std::string_view text, const std::string& source) {
  int line = 0;
  const auto header = NextRecord(text, line);
  if (!header || header->front().empty()) return Unreadable("no header line", source, 1);
  Json rows = Json::array();
  while (!text.empty()) {
    const int begin = line + 1;
    const auto record = NextRecord(text, line);
    if (!record) return Unreadable("a quote that does not end", source, begin);
    if (record->size() == 1 && record->front().empty()) continue;
    if (record->size() != header->size()) {
      return Unreadable(
          fmt::format("{} fields where the header has {}", record->size(), header->size()), source,
          begin);
    }
    Json row = Json::array();
    for (std::size_t i = 0; i < record->size(); ++i) {
      row.push_back(CellOf((*record)[i], IsWords((*header)[i])));
    }
    rows.push_back(std::move(row));
  }
  return Json{{"columns", *header}, {"rows", std::move(rows)}};
}

Json JsonOfToml(const toml::node& node) {
  if (const toml::table* table = node.as_table()) {
    Json object = Json::object();
    for (const auto& [key, value] : *table) object[std::string(key.str())] = JsonOfToml(value);
    return object;
  }
  if (const toml::array* array = node.as_array()) {
    Json list = Json::array();
    for (const toml::node& element : *array) list.push_back(JsonOfToml(element));
    return list;
  }
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* whole = node.as_integer()) return whole->get();
  if (const auto* number = node.as_floating_point()) return number->get();
  if (const auto* flag = node.as_boolean()) return flag->get();
  std::ostringstream instant;
  node.visit([&instant](const auto& value) {
    if constexpr (!toml::is_container<decltype(value)>) instant << value;
  });
  return instant.str();
}

Result<Json> JsonOfToml(std::string_view text, const std::string& source) {
  try {
    return JsonOfToml(toml::parse(text));
  } catch (const toml::parse_error& error) {
    return Fault{.code = FaultCode::kSyntax,
                 .text = std::string(error.description()),
                 .source = source,
                 .line = static_cast<int>(error.source().begin.line),
                 .column = static_cast<int>(error.source().begin.column)};
  }
}

}  // namespace wellgyro
