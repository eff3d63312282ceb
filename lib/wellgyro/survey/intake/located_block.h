#pragma once

#include <array>
#include <cstddef>

#include "wellgyro/base/time.h"
#include "wellgyro/record/along_hole_block.h"
#include "wellgyro/record/sample_block.h"

namespace wellgyro {

/// Samples with the UTC of their begins and the motion of the sensor point along the hole there and
/// at their middles, of which depth, speed and the speed's sigma may be all.
struct LocatedBlock {
  SampleBlock samples;
  std::array<UtcTime, SampleBlock::kMost> utc;
  AlongHoleBlock begin, middle;

  std::size_t size() const { return samples.size(); }
};

}  // namespace wellgyro
