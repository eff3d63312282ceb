#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "wellgyro/noise/allan_variance.h"

namespace wellgyro {

/// A rate whose size is above this is no number, and so is a sum: its square would overflow.
inline constexpr double kBeyondAnySensor = 1e140;
inline constexpr double kBeyondAnySum = 1e150;

/// Terms [begin, end) by their first sample.
struct TermRange {
  std::int64_t begin = 0;
  std::int64_t end = 0;
};

/// The terms over `window` successive samples of `samples` in which at most `allowed` are missing.
std::vector<TermRange> UsableTerms(std::int64_t samples, std::int64_t window, std::int64_t allowed,
                                   std::span<const SampleGap> gaps);

/// What stands in for a gap: the mean of as many samples on each side as are missing.
struct Bridge {
  SampleGap gap;
  double value = 0;
};
std::vector<Bridge> BridgesOver(std::span<const double> rate, std::span<const SampleGap> gaps);

/// Samples that no sensor gives: NaN, infinite, beyond 1e140.
std::vector<SampleGap> NotFinite(std::span<const double> rate);

/// Both lists in one, sorted, those that touch made one.
std::vector<SampleGap> Union(std::span<const SampleGap> a, std::span<const SampleGap> b);

}  // namespace wellgyro
