#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/io/exchange/line_reader_internal.h"
#include "wellgyro/record/survey_head.h"

namespace wellgyro::p717 {

/// One record, cut at its commas. Fields count from 0; those beyond its end are empty. Complaints
/// go to `lines`, with the field's number from 1.
class Record {
 public:
  explicit Record(const LineReader& lines) : lines_(lines) {}

  void Take(std::string_view line);
  std::size_t size() const { return fields_.size(); }

  std::string_view At(std::size_t i) const { return i < fields_.size() ? fields_[i] : ""; }
  std::string Text(std::size_t i) const { return std::string(At(i)); }
  /// A number times `factor`; nothing for an empty field or N/A.
  std::optional<double> Maybe(std::size_t i, double factor) const;
  double Needed(std::size_t i, double factor) const;
  int Integer(std::size_t i, int otherwise) const;
  [[noreturn]] void Odd(std::size_t i, std::string_view why) const;

 private:
  const LineReader& lines_;
  std::vector<std::string_view> fields_;
};

/// What a G7 record says; lengths in units of `md_unit` [m].
GyroRawRecord GyroRawOf(const Record& record, double md_unit);

}  // namespace wellgyro::p717
