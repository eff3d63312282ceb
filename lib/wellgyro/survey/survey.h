#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/time.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/record/station.h"

/// @file
/// What a survey is at one moment: stations, checks, runs, verdict.
namespace wellgyro {

struct RunFit;
struct RunSlip;

/// What one run came to.
struct RunSummary {
  std::int32_t run = 0;
  std::int32_t tool = 0;
  bool misrun = false;  ///< by someone's word
  RunVerdict verdict;   ///< by its checks
  std::string remark;
  UtcTime begin, end;
  std::int64_t samples = 0;            ///< accepted
  std::int64_t samples_lost = 0;       ///< by sequence number
  std::int64_t samples_after_end = 0;  ///< left out, because the job ends the run before them
  /// Without a depth, between the first and the last that had one, and of averages at rest [s].
  double seconds_without_depth = 0;
  std::int64_t duplicates = 0;  ///< sent again and skipped
  /// Impossible values, contradictory times, too late, or other; of all the tool's runs.
  std::int64_t samples_refused = 0;
  std::int64_t samples_other = 0;  ///< of these, that came again with another content
  std::int64_t clock_jumps = 0;    ///< of the tool's clock, its numbers or its UTC
  std::int64_t samples_gyro_saturated = 0, samples_accel_saturated = 0;
  std::int64_t samples_unsynced = 0;  ///< of which the surface doubts the UTC
  std::int64_t samples_gyro_mended = 0, samples_accel_mended = 0;  ///< single ones, see SpikeFilter
  std::int64_t samples_aliased = 0;  ///< that turned too far in one period
  std::int64_t samples_temperature_outside = 0;
  float temperature_min = 0, temperature_max = 0;  ///< [degC]
  /// How the run as a whole fits together; null before Adjust and Finish, and of a run that could
  /// not be adjusted. Its contents are in run.toml and checks, and not promised here.
  std::shared_ptr<const RunFit> fit;
  std::shared_ptr<const RunSlip> slip;  ///< by its passes; null before they are made
  std::vector<NorthFix> fixes;
  std::vector<Check> stop_checks;    ///< of three gyro axes at rest, beyond what a fix says
  std::vector<Check> sample_checks;  ///< of samples and depth marks as they come
};

/// Everything a survey is at one moment, for those who write files.
struct Survey {
  std::vector<Station> chosen;  ///< the tie-in, then one station per depth, depth increasing
  std::vector<Station> passes;  ///< every station of every run and pass, as last revised, in time
  std::vector<Check> checks;
  std::vector<RunSummary> runs;
  RunVerdict verdict;  ///< of the chosen stations, by the checks of the runs they are from
  std::int64_t marks_refused = 0;  ///< depth marks that were left out
  bool accepted = false;           ///< someone accepted a station: never to be written over
  std::string unusable;            ///< why there is no survey, in a sentence; empty: there is one
};

}  // namespace wellgyro
