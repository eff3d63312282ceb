#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/io/exchange/line_reader_internal.h"

namespace wellgyro {

/// The keywords of Petra's survey files, lines that begin with a star: *WELL and its name, *XYUNITS
/// and *DEPUNITS with F or M, *COLUMNS and a star before each column's name, on one line or
/// several.
class PetraHead {
 public:
  /// Takes such a line in; false for any other. Complains about units that are none.
  bool Take(std::string_view text, const LineReader& lines);
  bool any() const { return !columns_.empty(); }
  /// As headings of a table: "MD[ft]". Lengths without a unit stay without one.
  std::vector<std::string> Headings() const;
  const std::string& well() const { return well_; }

 private:
  std::string well_, across_, depths_;  // units as headings have them
  std::vector<std::string> columns_;
  bool in_columns_ = false;
};

}  // namespace wellgyro
