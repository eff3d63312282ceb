#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "wellgyro/record/station.h"

namespace wellgyro {

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
  Verdict verdict = Verdict::kNotDone;
};

}  // namespace wellgyro
