#include "wellgyro/io/sensor/bench_data.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/io/text_file.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

struct Word {
  std::string_view column, text;
  double value = 0;
};

constexpr Word kWords[] = {
    {"axis", "x", 0},    {"axis", "y", 1},     {"axis", "z", 2}, {"channel", "x", 0},
    {"channel", "y", 1}, {"channel", "z", 2},  {"dir", "up", 1}, {"dir", "down", -1},
    {"sign", "up", 1},   {"sign", "down", -1},
};

std::vector<std::string_view> Cells(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  SplitCells(line, separator, cells);
  return cells;
}

std::optional<double> ReadingOf(std::string_view column, std::string_view cell) {
  for (const Word& word : kWords) {
    if (column == word.column && cell == word.text) return word.value;
  }
  return NumberOf(cell);
}

// Reads line by line.
class Reader {
 public:
  explicit Reader(std::string source) { table_.source = std::move(source); }

  std::optional<Fault> Take(std::string_view line, int number) {
    const std::string_view text = TrimCell(line);
    if (text.empty() || text.starts_with('#')) return std::nullopt;
    return table_.columns.empty() ? Header(line, number) : Row(line, number);
  }

  Result<BenchTable> Finish() {
    if (table_.columns.empty()) return At(FaultCode::kForeign, "no header line", 1, 0);
    if (table_.lines.empty()) return At(FaultCode::kForeign, "no readings behind the header", 1, 0);
    const auto rows = static_cast<Eigen::Index>(table_.lines.size());
    const auto columns = static_cast<Eigen::Index>(table_.columns.size());
    table_.values =
        Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
            values_.data(), rows, columns);
    return std::move(table_);
  }

 private:
  Fault At(FaultCode code, std::string text, int line, int column) const {
    return {.code = code,
            .text = std::move(text),
            .source = table_.source,
            .line = line,
            .column = column};
  }

  std::optional<Fault> Header(std::string_view line, int number) {
    separator_ = DelimiterOf(line, ',');
    for (const std::string_view cell : Cells(line, separator_)) {
      const int column = static_cast<int>(cell.data() - line.data()) + 1;
      if (cell.empty()) return At(FaultCode::kForeign, "a column without a name", number, column);
      if (NumberOf(cell)) {
        return At(FaultCode::kForeign, "the first line must name the columns; it holds numbers",
                  number, column);
      }
      if (table_.Find(cell)) {
        return At(FaultCode::kConflict, fmt::format("column {} stands there twice", cell), number,
                  column);
      }
      table_.columns.emplace_back(cell);
    }
    return std::nullopt;
  }

  /// Why no reading of the column is `value`; empty where one can be.
  std::string WrongWith(double value, std::size_t column) const {
    constexpr double kLargest = 1e15;  // a double counts to 9e15, and no instrument further
    if (std::abs(value) > kLargest) return "is larger than any reading";
    // No chamber reaches either end; kelvin lie beyond it from -13 degC on.
    constexpr double kColdest = -150, kHottest = 260;
    if (table_.columns[column] != "T_C" || (value > kColdest && value < kHottest)) return "";
    return fmt::format("is no temperature of a bench, {} to {} degC: is it in kelvin or degF?",
                       kColdest, kHottest);
  }

  std::optional<Fault> Row(std::string_view line, int number) {
    const std::vector<std::string_view> cells = Cells(line, separator_);
    if (cells.size() != table_.columns.size()) {
      return At(FaultCode::kSize,
                fmt::format("{} cells where the header names {} columns", cells.size(),
                            table_.columns.size()),
                number, 1);
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto value = ReadingOf(table_.columns[i], cells[i]);
      const std::string wrong = value ? WrongWith(*value, i) : "is no number";
      if (!wrong.empty()) {
        return At(value ? FaultCode::kRange : FaultCode::kSyntax,
                  fmt::format("\"{}\" in column {} {}", cells[i], table_.columns[i], wrong), number,
                  static_cast<int>(cells[i].data() - line.data()) + 1);
      }
      values_.push_back(*value);
    }
    table_.lines.push_back(number);
    return std::nullopt;
  }

  BenchTable table_;
  std::vector<double> values_;
  char separator_ = ',';
};

}  // namespace

Result<BenchTable> ParseBenchTable(std::string_view text, const std::string& source) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  Reader reader(source);
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (auto fault = reader.Take(line, number)) return *std::move(fault);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return reader.Finish();
}

Result<BenchTable> ReadBenchTable(const std::filesystem::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  return ParseBenchTable(*text, path.string());
}

}  // namespace wellgyro
