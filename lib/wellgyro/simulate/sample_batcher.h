#pragma once

#include <cstdint>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/math/random.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/simulate/simulation.h"

namespace wellgyro {

/// One message of samples, without a gap inside.
struct SampleBatch {
  std::vector<ImuSample> samples;
};

/// Makes messages of a Simulator's samples, with the streams' batch size, overlap and losses.
class WELLGYRO_EXPORT SampleBatcher {
 public:
  /// Throws std::invalid_argument for a batch size below 1, an overlap that is negative or larger
  /// than the batch, or a probability outside [0, 1]. An overlap as large as the batch sends every
  /// sample twice, so that no single lost message loses a sample.
  SampleBatcher(const SimulatedStreams& streams, std::uint64_t seed);

  /// True when `sample` completes a message that arrives; `batch` is then that message.
  bool Push(const ImuSample& sample, SampleBatch& batch);
  /// True when samples were left that make a last, shorter message.
  bool Flush(SampleBatch& batch);

 private:
  bool Complete(SampleBatch& batch);

  SimulatedStreams streams_;
  Random loss_;
  std::vector<ImuSample> held_;
  std::size_t fresh_ = 0;
};

}  // namespace wellgyro
