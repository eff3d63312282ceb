#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "wellgyro/record/check.h"

/// How the checks of a survey are put together.
namespace wellgyro {

/// Of a run's pairs of stations, those that are independent, at most: errors are correlated along
/// the hole. At 40 kinds of checks a pair fails at 4.50 sigma; were they 18 or 72, at 4.35 or 4.64.
inline constexpr int kIndependentPairs = 36;

struct Measured {
  double value = 0, sigma = 0;
};

/// A check in SI units; `unit` divides what is written. Without `accepted` the limit is one of
/// chance, 3 sigma until ShareFalseAlarms() knows how many there are.
Check Compare(std::string code, std::int32_t run, Measured measured, std::optional<double> accepted,
              double unit, std::string unit_name);

/// The same against a limit that follows from `source`.
Check CompareWith(std::string code, std::int32_t run, Measured measured, double limit, double unit,
                  std::string unit_name, std::string source);

/// `count` of something of which there should be none, but which is flagged where it is and, where
/// it hides a part of the run, in the sigma: a warning.
Check CountOf(std::string code, std::int32_t run, std::int64_t count, std::string source);

/// The same of `count` among `all`: a warning up to 1 %, beyond that a failure.
Check ShareOf(std::string code, std::int32_t run, std::int64_t count, std::int64_t all,
              std::string source);

Check NotDone(std::string code, std::int32_t run, std::string why);

}  // namespace wellgyro
