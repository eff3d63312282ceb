#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/record/station.h"

/// @file
/// Quality checks, and the verdict on a run.
namespace wellgyro {

/// How a check, or all checks of a run, came out.
enum class Verdict { kPass, kWarn, kFail, kNotDone };

/// One quality check. What could not be checked is listed as such: kNotDone without a value.
struct Check {
  std::string code;      ///< stable name, as "gravity" or "foresight"
  std::int32_t run = 0;  ///< 0: the whole job
  std::optional<Pass> pass;
  std::optional<double> md;     ///< [m]
  std::optional<double> value;  ///< in `unit`
  std::optional<double> sigma;
  std::optional<double> limit;
  std::string unit;          ///< as written in files: deg, m, m/s2, deg/h, 1
  std::string limit_source;  ///< where the limit comes from
  /// Number of independent comparisons of which `value` is the worst, where chance alone sets the
  /// limit: all such checks of a run then share one rate of false alarms (README, "Verdict"). 0:
  /// the limit is another.
  double looks = 0;
  double freedom = 0;  ///< of chi-square over it, where `value` is that; 0: value / sigma is normal
  Verdict verdict = Verdict::kNotDone;
};

/// What a run, or a whole survey, is worth to those who are handed it: pass, warn or fail, never
/// not_done, and why. A survey that fails is whole, but not to be handed over as it is.
struct RunVerdict {
  Verdict verdict = Verdict::kPass;
  std::vector<std::string> causes = {};  ///< in words, each failing one before any other
};

}  // namespace wellgyro
