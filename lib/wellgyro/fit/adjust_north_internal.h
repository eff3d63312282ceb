#pragma once

#include <cstddef>
#include <vector>

#include "wellgyro/fit/adjust_problem_internal.h"

namespace wellgyro {

/// Consecutive nodes whose azimuths hang together.
struct AdjustSegment {
  std::size_t begin, end;
};

std::vector<AdjustSegment> SegmentsOf(const std::vector<AdjustSpan>& spans);

/// What the search for north came to, for one segment.
struct AdjustNorth {
  double azimuth = 0;      ///< of the segment's last node
  std::size_t epoch = 0;   ///< at whose end the segment's azimuth is known best
  bool ambiguous = false;  ///< another azimuth fits nearly as well, or nearly all do
  // Where the cost is no parabola, as near horizontal and east-west, the curvature at its bottom
  // says too much or too little:
  double var_beyond = 0;  ///< of the azimuths' common error, above that of the curvature [rad^2]
  /// Of the azimuth at `epoch` as if measured, which the curvature lacks [rad^2]; 0: none.
  double var_hold = 0;
};

/// Tries azimuths all round for the nodes of a segment, starting from `azimuths`, which the nodes
/// of all others also start from; then the cost itself on both sides of the best.
AdjustNorth FindNorth(const AdjustSegment& segment, const std::vector<double>& azimuths,
                      AdjustProblem* problem);

}  // namespace wellgyro
