#include "wellgyro/io/survey_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

enum Quantity { kMd, kInc, kAzi, kNorth, kEast, kTvd, kQuantities };

struct ColumnName {
  std::string_view name;
  Quantity quantity;
  NorthReference north = NorthReference::kUnstated;
};

constexpr ColumnName kColumns[] = {
    {"md", kMd},
    {"inc", kInc},
    {"incl", kInc},
    {"inclination", kInc},
    {"azi", kAzi},
    {"azim", kAzi},
    {"azimuth", kAzi},
    {"azi_true", kAzi, NorthReference::kTrue},
    {"azimuth_true", kAzi, NorthReference::kTrue},
    {"azi_grid", kAzi, NorthReference::kGrid},
    {"azimuth_grid", kAzi, NorthReference::kGrid},
    {"n", kNorth},
    {"north", kNorth},
    {"e", kEast},
    {"east", kEast},
    {"tvd", kTvd},
};

/// Where a quantity stands; `si` turns its numbers into SI.
struct Column {
  std::size_t index = 0;
  double si = 1;
  bool unit_stated = false;
};

struct Header {
  char separator = ',';
  std::array<std::optional<Column>, kQuantities> columns;
  NorthReference north = NorthReference::kUnstated;
};

struct Cell {
  std::string_view text;
  int column = 1;  ///< from 1, in the line
};

bool IsBlank(char c) { return c == ' ' || c == '\t'; }

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && IsBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsBlank(text.back())) text.remove_suffix(1);
  return text;
}

/// Cells of a line; blanks separate when `separator` is a space, however many.
std::vector<Cell> Cells(std::string_view line, char separator) {
  std::vector<Cell> cells;
  std::size_t at = 0;
  while (at <= line.size()) {
    if (separator == ' ') {
      while (at < line.size() && IsBlank(line[at])) ++at;
      if (at == line.size()) break;
    }
    const auto ends = [&](char c) { return separator == ' ' ? IsBlank(c) : c == separator; };
    const auto* const end = std::find_if(line.begin() + at, line.end(), ends);
    const auto length = static_cast<std::size_t>(end - (line.begin() + at));
    cells.push_back({Trimmed(line.substr(at, length)), static_cast<int>(at) + 1});
    at += length + 1;
  }
  return cells;
}

/// "md" and "ft" of "md[ft]", "md (ft)" and "md_ft".
std::pair<std::string_view, std::string_view> SplitUnit(std::string_view name) {
  if (const auto open = name.find_first_of("[("); open != std::string_view::npos) {
    const std::string_view unit = name.substr(open + 1);
    return {Trimmed(name.substr(0, open)), unit.substr(0, unit.find_first_of("])"))};
  }
  for (const std::string_view ending : {"_deg", "_m", "_ft"}) {
    if (!name.ends_with(ending)) continue;
    return {name.substr(0, name.size() - ending.size()), ending.substr(1)};
  }
  return {name, {}};
}

bool TurnsBack(const SurveyPoint& a, const SurveyPoint& b) {
  constexpr double kOpposite = -0.999;  // cosine; no arc joins opposite directions
  return Tangent(a.inclination, a.azimuth).dot(Tangent(b.inclination, b.azimuth)) < kOpposite;
}

class TableReader {
 public:
  TableReader(std::string_view text, const std::string& source, NorthReference wanted)
      : text_(text), source_(source), wanted_(wanted) {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
  }

  Result<SurveyTable> Read() {
    bool headed = false;
    std::string_view line;
    while (Next(line)) {
      if (Trimmed(line).empty() || line.front() == '#') continue;
      const auto fault = headed ? ReadRow(line) : ReadHeader(line);
      if (fault) return *fault;
      headed = true;
    }
    if (!headed) return Wrong(FaultCode::kForeign, "is empty", 1);
    if (table_.stations.size() < 2) {
      return Wrong(FaultCode::kRange, "a survey needs at least two stations", 1);
    }
    return std::move(table_);
  }

 private:
  bool Next(std::string_view& line) {
    if (text_.empty()) return false;
    const std::size_t end = std::min(text_.find('\n'), text_.size());
    line = text_.substr(0, end);
    text_.remove_prefix(std::min(end + 1, text_.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++line_number_;
    return true;
  }

  Fault Wrong(FaultCode code, std::string text, int column) const {
    return Fault{.code = code,
                 .text = std::move(text),
                 .source = source_,
                 .line = line_number_,
                 .column = column};
  }

  std::optional<Fault> ReadHeader(std::string_view line) {
    for (const char c : {',', ';', '\t', ' '}) {
      header_.separator = c;
      if (line.find(c) != std::string_view::npos) break;
    }
    const std::vector<Cell> cells = Cells(line, header_.separator);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (auto fault = TakeColumn(cells[i], i)) return fault;
    }
    for (const auto& [quantity, name] : {std::pair(kMd, "MD"), {kInc, "INC"}, {kAzi, "AZI"}}) {
      if (!header_.columns[quantity]) {
        return Wrong(FaultCode::kForeign,
                     fmt::format("no column {}; the header must have MD, INC and AZI, as "
                                 "MD[m],INC[deg],AZI_TRUE[deg]",
                                 name),
                     1);
      }
    }
    table_.north = header_.north;
    table_.depth_unit_stated = header_.columns[kMd]->unit_stated;
    return std::nullopt;
  }

  std::optional<Fault> TakeColumn(const Cell& cell, std::size_t index) {
    std::string name;
    for (const char c : cell.text) {
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    const auto [bare, unit] = SplitUnit(name);
    const auto known = std::ranges::find(kColumns, bare, &ColumnName::name);
    if (known == std::end(kColumns)) return std::nullopt;
    const bool angle = known->quantity == kInc || known->quantity == kAzi;
    Column column{index, angle ? units::kDeg : 1, !unit.empty()};
    if (!angle && unit == "ft") column.si = units::kFoot;
    const bool fits = unit.empty() || (angle ? unit == "deg" : unit == "m" || unit == "ft");
    if (!fits) {
      return Wrong(FaultCode::kForeign,
                   fmt::format("unit '{}' of column {} is not {}", unit, cell.text,
                               angle ? "deg" : "m or ft"),
                   cell.column);
    }
    return Keep(*known, column, cell);
  }

  std::optional<Fault> Keep(const ColumnName& known, const Column& column, const Cell& cell) {
    auto& place = header_.columns[known.quantity];
    if (known.quantity == kAzi && place) {
      const bool differ = header_.north != known.north;
      if (differ && known.north != wanted_) return std::nullopt;
      if (!differ) {
        return Wrong(FaultCode::kForeign, fmt::format("column {} stands twice", cell.text),
                     cell.column);
      }
    } else if (place) {
      return Wrong(FaultCode::kForeign, fmt::format("column {} stands twice", cell.text),
                   cell.column);
    }
    place = column;
    if (known.quantity == kAzi) header_.north = known.north;
    return std::nullopt;
  }

  std::optional<Fault> ReadNumber(const std::vector<Cell>& cells, Quantity quantity,
                                  double& value) {
    const Column& column = *header_.columns[quantity];
    if (column.index >= cells.size()) {
      return Wrong(FaultCode::kSyntax, "the row has fewer cells than the header", 1);
    }
    const Cell& cell = cells[column.index];
    std::string_view text = cell.text;
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || rest != text.data() + text.size()) {
      return Wrong(FaultCode::kSyntax, fmt::format("'{}' is no number", cell.text), cell.column);
    }
    constexpr double kFarthest = 1e6;  // of any unit
    if (!std::isfinite(value) || std::abs(value) > kFarthest) {
      return Wrong(FaultCode::kRange, fmt::format("'{}' cannot be", cell.text), cell.column);
    }
    value *= column.si;
    return std::nullopt;
  }

  std::optional<Fault> ReadRow(std::string_view line) {
    const std::vector<Cell> cells = Cells(line, header_.separator);
    SurveyPoint p;
    if (auto fault = ReadNumber(cells, kMd, p.md)) return fault;
    if (auto fault = ReadNumber(cells, kInc, p.inclination)) return fault;
    if (auto fault = ReadNumber(cells, kAzi, p.azimuth)) return fault;
    if (p.inclination < 0 || p.inclination > kPi) {
      return Wrong(FaultCode::kRange, "the inclination is not within 0 and 180 deg",
                   cells[header_.columns[kInc]->index].column);
    }
    p.azimuth = WrapTwoPi(p.azimuth);
    if (!table_.stations.empty() && p.md <= table_.stations.back().md) {
      return Wrong(FaultCode::kOrder, "measured depth does not increase",
                   cells[header_.columns[kMd]->index].column);
    }
    if (!table_.stations.empty() && TurnsBack(table_.stations.back(), p)) {
      return Wrong(FaultCode::kRange, "the hole points back the way it came", 1);
    }
    if (table_.stations.empty()) {
      if (auto fault = ReadStart(cells)) return fault;
    }
    table_.stations.push_back(p);
    return std::nullopt;
  }

  std::optional<Fault> ReadStart(const std::vector<Cell>& cells) {
    if (!header_.columns[kNorth] || !header_.columns[kEast] || !header_.columns[kTvd]) {
      return std::nullopt;
    }
    Eigen::Vector3d start;
    if (auto fault = ReadNumber(cells, kNorth, start.x())) return fault;
    if (auto fault = ReadNumber(cells, kEast, start.y())) return fault;
    if (auto fault = ReadNumber(cells, kTvd, start.z())) return fault;
    table_.start = start;
    return std::nullopt;
  }

  std::string_view text_;
  const std::string& source_;
  NorthReference wanted_;
  int line_number_ = 0;
  Header header_;
  SurveyTable table_;
};

}  // namespace

Result<SurveyTable> ParseSurveyTable(std::string_view text, const std::string& source,
                                     NorthReference wanted) {
  return TableReader(text, source, wanted).Read();
}

Result<SurveyTable> ReadSurveyTable(const std::filesystem::path& path, NorthReference wanted) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  return ParseSurveyTable(*text, path.string(), wanted);
}

}  // namespace wellgyro
