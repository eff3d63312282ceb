#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/io/exchange/certificate_internal.h"
#include "wellgyro/io/exchange/las_internal.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"

namespace wellgyro {

std::string las::DataText(std::string_view text) {
  std::string clean;
  for (const char c : text) {
    if (c == ':') {
      clean += kColonLetter;
    } else {
      clean += c == '\n' || c == '\r' ? ' ' : c;
    }
  }
  return clean;
}

std::string las::FromDataText(std::string_view data) {
  std::string text(data);
  for (std::size_t at = text.find(kColonLetter); at != std::string::npos;
       at = text.find(kColonLetter, at + 1)) {
    text.replace(at, kColonLetter.size(), ":");
  }
  return text;
}

namespace {

std::string LasUnit(Quantity quantity, const SurveyHead& head) {
  std::string unit = UnitOf(quantity, head);
  for (char& c : unit) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
  return unit;
}

// A number that no column holds, to stand for nothing.
double NullFor(const SurveyTable& table, const std::vector<Column>& columns) {
  for (double null : {-999.25, -9999.25, -99999.25, -999999.25}) {
    bool free = true;
    for (const Column column : columns) {
      const double factor = FactorOf(InfoOf(column).quantity, table.head);
      for (std::size_t row = 0; row < table.rows() && free; ++row) {
        const auto value = table.Get(column, row);
        free = !value || std::abs(*value / factor - null) > 1e-6;
      }
    }
    if (free) return null;
  }
  return -1e30;
}

// The common step of depths in the file's unit, or 0.
double StepOf(const SurveyTable& table, const std::vector<std::size_t>& rows) {
  if (rows.size() < 2) return 0;
  const double factor = FactorOf(table.head.md_unit);
  const auto depth = [&](std::size_t i) { return table.md(rows[i]) / factor; };
  const double n = static_cast<double>(rows.size() - 1);
  const double step = std::round((depth(rows.size() - 1) - depth(0)) / n * 1e6) / 1e6;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double expected = depth(0) + static_cast<double>(i) * step;
    if (std::abs(depth(i) - expected) > 1e-9 * std::max(1.0, std::abs(expected))) return 0;
  }
  return step;
}

class LasWriter {
 public:
  LasWriter(const SurveyTable& table, const WriteOptions& options)
      : table_(table), head_(table.head) {
    for (std::size_t row = 0; row < table.rows(); ++row) {
      if (OnPath(table.status(row))) rows_.push_back(row);
    }
    if (rows_.empty()) Lacks("LAS", "a station");
    for (const ColumnInfo& info : AllColumns()) {
      if (table.Has(info.column)) columns_.push_back(info.column);
    }
    null_ = Exact(NullFor(table, columns_));
    step_ = options.variable_step ? 0 : StepOf(table, rows_);
  }

  std::string Write() {
    Entry("VERS", "", "2.0", "CWLS LOG ASCII STANDARD - VERSION 2.0");
    Entry("WRAP", "", "NO", "ONE LINE PER DEPTH STEP");
    Well();
    Curves();
    Parameters();
    Other();
    Data();
    return "~VERSION INFORMATION\n# " + CertificateText(rows_.size(), text_) + "\n" + text_;
  }

 private:
  void Entry(std::string_view mnemonic, std::string_view unit, std::string_view data,
             std::string_view description) {
    const std::string start = fmt::format(" {:<9}.{:<9}", mnemonic, unit);
    text_ += fmt::format("{} {:>20} : {}\n", start, las::DataText(data), description);
  }

  void Well() {
    const std::string unit = LasUnit(Quantity::kLength, head_);
    const double factor = FactorOf(head_.md_unit);
    text_ += "~WELL INFORMATION\n";
    Entry("STRT", unit, Exact(table_.md(rows_.front()), factor), "START DEPTH");
    Entry("STOP", unit, Exact(table_.md(rows_.back()), factor), "STOP DEPTH");
    Entry("STEP", unit, Exact(step_), "STEP, 0 IF VARIABLE");
    Entry("NULL", "", null_, "NULL VALUE");
    for (const las::WellKey& key : las::kWellKeys) {
      Entry(key.mnemonic, "", head_.names.*key.member, key.text);
    }
  }

  void Curves() {
    text_ += "~CURVE INFORMATION\n";
    for (const Column column : columns_) {
      const ColumnInfo& info = InfoOf(column);
      std::string description(info.text);
      if (column == Column::kAzimuth) {
        description += fmt::format(" from {} north", WordOf(head_.azimuth.north));
      }
      Entry(info.las, LasUnit(info.quantity, head_), "", description);
    }
  }

  void Parameters() {
    text_ += "~PARAMETER INFORMATION\n";
    const Pairs pairs = PairsOf(head_);
    for (const las::ParameterKey& p : las::kParameters) {
      for (const auto& [key, value] : pairs) {
        if (key == p.key) Entry(p.mnemonic, p.unit, value, p.text);
      }
    }
  }

  void Other() {
    if (!head_.remarks.empty()) text_ += "~OTHER INFORMATION\n";
    for (const std::string& remark : head_.remarks) {
      const std::string line = las::DataText(remark);
      text_ += (line.starts_with('~') || line.starts_with('#') ? " " : "") + line + "\n";
    }
  }

  void Data() {
    text_ += "~A\n";
    // Of a column: sign, seven digits, point and four, and a space.
    constexpr std::size_t kWidth = 14;
    for (const std::size_t row : rows_) {
      for (const Column column : columns_) {
        const auto value = table_.Get(column, row);
        const std::string cell = value ? Exact(InfoOf(column).quantity, *value, head_) : null_;
        if (column != columns_.front()) text_ += ' ';
        if (cell.size() < kWidth) text_.append(kWidth - cell.size(), ' ');
        text_ += cell;
      }
      text_ += '\n';
    }
  }

  const SurveyTable& table_;
  const SurveyHead& head_;
  std::vector<std::size_t> rows_;
  std::vector<Column> columns_;
  std::string null_;
  double step_ = 0;
  std::string text_;
};

}  // namespace

std::string WriteLas(const SurveyTable& table, const WriteOptions& options) {
  NeedNorth(table, "LAS");
  return LasWriter(table, options).Write();
}

}  // namespace wellgyro
