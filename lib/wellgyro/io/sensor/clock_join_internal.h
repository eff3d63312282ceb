#pragma once

#include <filesystem>
#include <optional>

#include "wellgyro/base/result.h"
#include "wellgyro/depth/stop_match.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/survey/job.h"

namespace wellgyro::sensors {

/// A table of samples on the tool's clock and one of depth in UTC.
struct ClockTables {
  const std::filesystem::path& samples;
  const std::filesystem::path& depth;
};

struct JoinedClocks {
  StopMatch match;
  SampleStamp first, last;  ///< of the samples
};

/// Ties the clocks by the rests of tool and depth, see MatchStops().
///
/// A rest's edges are noted in steps, the tool's of a second, the depth's from mark to mark. Where
/// stops last whole steps s, which no scatter tells, all of them err alike: begin and end by up to
/// a step each, so that the offset's variance has s^2 / 24 of either clock. Faults: those of
/// MatchStops(), and a row that cannot be read.
Result<JoinedClocks> JoinByStops(const ClockTables& tables, const Job& job);

/// Moves the tie by the lag of depth that starts and stops show to the accelerometers, see
/// DepthMotion: some milliseconds, where rests tell it to some tenths of a second. Not where they
/// show none, or one that rests exclude. Faults: a row that cannot be read.
std::optional<Fault> RefineByMotion(const ClockTables& tables, StopMatch& match);

}  // namespace wellgyro::sensors
