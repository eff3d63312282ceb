#pragma once

#include <span>

#include "wellgyro/attitude/filter.h"
#include "wellgyro/attitude/smoother.h"
#include "wellgyro/base/export.h"
#include "wellgyro/record/increment.h"

namespace wellgyro {

/// What makes the final stations of a run from everything that was measured in it, for whoever
/// would put another estimator in place of EstimatedRun().
class WELLGYRO_EXPORT RunAdjuster {
 public:
  virtual ~RunAdjuster();

  /// One attitude for every epoch and one state for every marked station of `history`, as Smooth()
  /// gives them, and how they fit: the states of neighbours in time form a Markov chain.
  /// `increments`: see RunSurvey. Must not throw for any history that a filter leaves behind.
  virtual SmoothedRun Adjust(const FilterHistory& history,
                             std::span<const Increment> increments) const = 0;
};

}  // namespace wellgyro
