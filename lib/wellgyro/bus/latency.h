#pragma once

#include <array>
#include <cstdint>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Delays of messages, for their percentiles: in classes of 10 % from 1 us to beyond a day.
class WELLGYRO_EXPORT Latency {
 public:
  void Add(std::int64_t us);
  /// What a share of all delays lay below [us], to 10 %; 0 when there were none.
  std::int64_t Of(double share) const { return Of(counts_, share); }
  /// The 99th percentile since the last reset [us].
  std::int64_t Recent(bool reset);

 private:
  using Counts = std::array<std::int64_t, 280>;
  static std::int64_t Of(const Counts& counts, double share);

  Counts counts_{}, recent_{};
};

}  // namespace wellgyro
