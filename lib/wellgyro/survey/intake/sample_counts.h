#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "wellgyro/record/sample.h"
#include "wellgyro/record/sample_block.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// Adds `samples` samples, all stamped alike but for time and number, to a run's counts: how many
/// there are, how many were beyond the tool's range or its calibrated temperatures, and of how many
/// the surface doubts the UTC.
void CountSamples(const SampleStamp& stamp, std::int64_t samples, RunSummary& summary);

/// [m/s^2], 6 deg of inclination; white noise of 2e-4 m/s^2/sqrt(Hz) is 6e-3 at 1 kHz.
inline constexpr double kSeenAcross = 1;

/// Gravity across the tool turns by more than a right angle from one sample to the next, and is
/// such that no noise makes it: the roll between them is not known.
inline bool TurnsFar(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const double least = std::min(from.squaredNorm(), to.squaredNorm());
  return from.dot(to) < 0 && least > kSeenAcross * kSeenAcross;
}

/// How often it does so from `from` on through samples.
inline std::int64_t FarTurns(Eigen::Vector2d from, std::span<const SixAxes> samples) {
  std::int64_t count = 0;
  double square = from.squaredNorm();
  for (const SixAxes& axes : samples) {
    const Eigen::Vector2d to = axes.segment<2>(3);
    const double next = to.squaredNorm();
    const bool back = from.dot(to) < 0;
    count += back & (std::min(square, next) > kSeenAcross * kSeenAcross);
    from = to;
    square = next;
  }
  return count;
}

}  // namespace wellgyro
