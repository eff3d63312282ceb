#pragma once

#include "wellgyro/base/export.h"
#include "wellgyro/survey/run/run_history.h"

namespace wellgyro {

class Surveyor;

/// What makes the final stations of a run from everything that was measured in it. A surveyor takes
/// EstimatedRun(), unless another is put in its place.
class WELLGYRO_EXPORT RunAdjuster {
 public:
  virtual ~RunAdjuster();

  /// One attitude for every knot and one state for every station of `history`, and how they fit:
  /// the states of neighbours in time form a Markov chain. Must not throw for any history that a
  /// run leaves behind.
  virtual SmoothedRun Adjust(const RunHistory& history) const = 0;
};

/// Final stations are those of `adjuster`, which must outlive the surveyor: before the first push.
WELLGYRO_EXPORT void AdjustBy(const RunAdjuster& adjuster, Surveyor& surveyor);

}  // namespace wellgyro
