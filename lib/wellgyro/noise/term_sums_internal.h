#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "wellgyro/noise/gap_terms_internal.h"

namespace wellgyro {

/// The sum of squared differences at one averaging factor over its usable terms.
struct TermSum {
  std::int64_t factor = 0;
  std::vector<TermRange> usable;
  std::int64_t terms = 0;
  double squares = 0;
};

/// The rates of one analysis as the sums see them.
struct BridgedRates {
  std::span<const double> rate;
  double shift = 0;  ///< taken off every rate: any value near them
  std::span<const Bridge> bridges;
  std::function<void(double)> progress;
};

/// Fill `terms` and `squares` of the sums, which hold their factors and usable terms: of
/// sum(next m) - sum(m). False when a rate is not finite; the sums are then worth nothing.
bool SumOverlapped(const BridgedRates& rates, std::span<TermSum> sums);
/// The same of the terms whose first sample is a multiple of m.
bool SumSideBySide(const BridgedRates& rates, std::span<TermSum> sums);
/// Of m successive differences added.
bool SumModified(const BridgedRates& rates, std::span<TermSum> sums);

}  // namespace wellgyro
