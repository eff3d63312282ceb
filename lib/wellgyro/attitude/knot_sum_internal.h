#pragma once

#include <cstdint>

#include "wellgyro/attitude/roll_smoother_internal.h"
#include "wellgyro/record/increment.h"

namespace wellgyro::increment {

/// A knot between two instants of the builder's axis, in blocks that are turned already.
struct KnotSpan {
  std::int64_t begin_ns, end_ns;
  std::uint64_t begin_block, end_block;  ///< that hold begin and end; end_block inclusive
};

/// Sums the blocks of `span` to an increment, all but its time.
Increment SumKnot(const KnotSpan& span, bool third, double accel_noise, const Blocks& blocks);

}  // namespace wellgyro::increment
