#pragma once

#include <optional>
#include <span>

#include <CLI/CLI.hpp>

#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/fit/affine_fit.h"

#include "bench_options.h"

namespace wellgyro::apps {

/// What a method made of the bench's readings.
struct BenchOutcome {
  BenchCalibration calibration;
  std::optional<OrthogonalityCheck> check;
};

/// One method: its subcommand's words, the options that it has beside --data and --out, and what it
/// makes of the readings.
struct BenchMethod {
  const char* name;
  const char* help;
  const char* columns;  ///< of its readings
  const char* needs;    ///< options that it cannot do without, as an example gives them
  void (*add_options)(CLI::App& command, BenchOptions& o);
  /// `joined` has no rows where none were given.
  Result<BenchOutcome> (*fit)(const BenchTable& data, const BenchTable& joined, BenchOptions& o);
  const char* joined_role = "";  ///< of the readings to join, in the calibration file
};

/// All methods, in the order of the help.
std::span<const BenchMethod> BenchMethods();

}  // namespace wellgyro::apps
