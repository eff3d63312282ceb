#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "wellgyro/record/check.h"

/// How the checks of a survey are put together.
namespace wellgyro {

struct Measured {
  double value = 0, sigma = 0;
};

/// A check in SI units; `unit` divides what is written. Without `accepted` the limit is 3 sigma.
Check Compare(std::string code, std::int32_t run, Measured measured, std::optional<double> accepted,
              double unit, std::string unit_name);

/// The same against a limit that follows from `source`.
Check CompareWith(std::string code, std::int32_t run, Measured measured, double limit, double unit,
                  std::string unit_name, std::string source);

/// `count` of something of which there should be none.
Check CompareCount(std::string code, std::int32_t run, std::int64_t count, std::string source);

Check NotDone(std::string code, std::int32_t run, std::string why);

}  // namespace wellgyro
