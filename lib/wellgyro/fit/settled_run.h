#pragma once

#include <span>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// What a channel comes to when a position's readings have settled.
struct SettledRun {
  double value = 0;      ///< in the readings' unit
  int used = 0;          ///< readings that it rests on
  bool settled = false;  ///< false: they still drift, or are fewer than three
  double spread = 0;     ///< of the last three readings, largest less smallest
};

/// The mean of a position's readings, in order of time, without the transient at their begin.
///
/// Eight readings and more: a constant plus a decaying exponential, where that fits better than the
/// constant alone (F test, one false in a thousand); its asymptote is the value. Stopping "when the
/// last readings repeat" instead keeps a part of the transient. Fewer: the mean of the longest run
/// at their end that agrees within `tolerance`, three at least. Not settled: what is left of the
/// transient at the last reading is above `tolerance`.
WELLGYRO_EXPORT SettledRun Settle(std::span<const double> readings, double tolerance);

}  // namespace wellgyro
