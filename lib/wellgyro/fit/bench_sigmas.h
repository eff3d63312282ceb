#pragma once

/// @file
/// What people state of a bench before its readings, in units of their own: one list for the
/// program's options, for Python's arguments and for what a calibration says it rests on.

#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/fit/tool_fit.h"

namespace wellgyro {

/// One sigma of ToolFitSetup.
struct BenchSigma {
  std::string_view name;     ///< "level-deg": --level-deg, level_deg; the unit stands in it
  double unit = 1;           ///< one of the name's unit in that of the setup
  std::string_view meaning;  ///< "1 sigma of a bench's tilt"
  using Known = double ToolFitSetup::*;
  using Found = std::optional<double> ToolFitSetup::*;  ///< from the readings where it is not given
  std::variant<Known, Found> held;

  /// In the name's unit; none where it is to be found.
  WELLGYRO_EXPORT std::optional<double> Of(const ToolFitSetup& setup) const;
  /// Takes a number in the name's unit.
  WELLGYRO_EXPORT void Take(double value, ToolFitSetup& setup) const;
};

/// All of them, in the order in which they are said.
WELLGYRO_EXPORT std::span<const BenchSigma> BenchSigmas();

/// What a calibration lists as known before: `site`, as "latitude-deg 60", which was stated;
/// gravity where it was not; then the sigmas, of which those whose names are in `stated` were, and
/// the degree of biases.
WELLGYRO_EXPORT std::vector<std::string> BenchReferences(
    std::span<const std::string> site, const ToolFitSetup& setup,
    const std::set<std::string, std::less<>>& stated);

}  // namespace wellgyro
