#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "wellgyro/record/survey_table.h"

namespace wellgyro {

/// A column's heading taken apart: what it is, its unit as written, and the north it names.
struct Heading {
  std::optional<Column> column;
  std::optional<TextColumn> text;
  bool status = false;
  bool well = false;         ///< names the well of its row
  bool either_axis = false;  ///< X or Y: which of them is the east must be seen
  bool told = false;         ///< by an option, not by the file
  std::string unit;
  North north = North::kUnknown;
};
/// From any name that importers and vendors use, as "Measured Depth ( ft )" or "AZI_TRUE[deg]".
Heading HeadingOf(std::string_view heading);

/// Where azimuths by this north go in a table whose azimuths are by another; none for an unknown.
std::optional<Column> SecondAzimuth(North north);

}  // namespace wellgyro
