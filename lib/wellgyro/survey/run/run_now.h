#pragma once

#include <cstdint>
#include <optional>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"

namespace wellgyro {

class Surveyor;
struct RunState;

/// How far a run that goes on is known: up to its last knot, 6 to 12 s behind its samples.
struct RunNow {
  std::int32_t run = 0;
  UtcTime utc;               ///< of the end of that knot
  std::optional<double> md;  ///< there [m]
  double rested = 0;         ///< at rest since [s]
  /// What is known there; null: no north yet. It holds until something is pushed.
  const RunState* state = nullptr;
};

/// How far the run of `tool` that goes on is known: for who gives advice.
WELLGYRO_EXPORT RunNow NowOf(const Surveyor& surveyor, std::int32_t tool);

}  // namespace wellgyro
