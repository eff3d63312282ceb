#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "wellgyro/base/time.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/increment.h"
#include "wellgyro/record/quality.h"
#include "wellgyro/survey/stations/draft.h"

namespace wellgyro {

inline constexpr std::int64_t kSameNs = 2;  ///< one place, cut twice and each rounded to 1 ns

/// A knot that has been cut and waits for its increment, 6 to 12 s. What the samples and the depth
/// say of it is known at once; whether it is at rest, and its increment, come later.
struct WaitingKnot {
  ToolTime begin, end;
  UtcTime utc;                 ///< of its end, and there:
  AlongHole along;             ///< the place; a station's depth is the one asked for
  std::optional<Draft> draft;  ///< a station is wanted there
  std::optional<Increment> increment;
  bool external = false;             ///< the job's azimuth holds here
  std::optional<bool> still;         ///< once it is decided
  std::optional<std::size_t> told;   ///< the draft's number, where it is already among the drafts
  Quality quality = Quality::kGood;  ///< kTemperature and kAliased, of any sample since `begin`
  float temperature = 0;             ///< [degC]
};

/// In the order of time: the door between what cuts samples into knots and what is estimated from
/// them.
using WaitingKnots = std::deque<WaitingKnot>;

}  // namespace wellgyro
