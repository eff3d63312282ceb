#pragma once

#include <span>
#include <string_view>

#include "wellgyro/estimate/cause.h"

namespace wellgyro {

inline constexpr std::string_view kDepthScaleCause = "depth_scale",
                                  kRestMotionCause = "rest_motion";

/// A fault that is looked for in a run's rows.
struct KnownCause {
  std::string_view code;
  CauseSpec::Kind kind;
  int unknown;  ///< as of CauseSpec
  double size;  ///< 1 sigma where the fault is there, in `unit`
  double unit;  ///< in SI
  std::string_view unit_name, remedy;
};

/// All of them, "other" the last, in the order of CausesLookedFor().
std::span<const KnownCause> KnownCauses();

/// What to do where a check fails that by itself names what is wrong with samples or marks; empty
/// for other checks.
std::string_view RemedyOfSamples(std::string_view check);

}  // namespace wellgyro
