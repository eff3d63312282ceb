#pragma once

#include <span>

#include "wellgyro/attitude/filter.h"
#include "wellgyro/attitude/smoother.h"
#include "wellgyro/base/export.h"
#include "wellgyro/record/increment.h"

namespace wellgyro {

/// What makes the final stations of a run from everything that was measured in it, in place of
/// what the job's estimator says. fit/ has one for the estimator in angles.
class WELLGYRO_EXPORT RunAdjuster {
 public:
  virtual ~RunAdjuster();

  /// One attitude for every epoch and one state for every marked station of `history`, as Smooth()
  /// gives them, and how they fit: the states of neighbours in time form a Markov chain.
  /// `increments`: see RunSurvey.
  /// `sigma_lie`: how differently the tool lies in the hole each time it passes a place, 1-sigma of
  /// an angle [rad]. Must not throw for any history that a filter leaves behind.
  virtual SmoothedRun Adjust(const FilterHistory& history, std::span<const Increment> increments,
                             double sigma_lie) const = 0;
};

}  // namespace wellgyro
