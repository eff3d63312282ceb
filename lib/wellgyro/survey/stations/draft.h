#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "wellgyro/attitude/station_state.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/station.h"
#include "wellgyro/survey/stations/way.h"

namespace wellgyro {

/// A station before it has a position: who and when it is, and where its attitude comes from.
struct Draft {
  Station station;  ///< run, pass, depth, time, status; attitude and position come later
  /// Index among the run's stations from samples; absent: `attitude` holds.
  std::optional<std::size_t> state;
  AttitudeSample attitude;  ///< of the tool, where it does not come from samples
  /// See NorthFix; of `attitude`.
  std::optional<double> mirror_azimuth;
  double mirror_cost = 0;
  bool listed = true;   ///< false: only ties others together, or not asked for after all
  bool closes = false;  ///< the survey as last adjusted; the next may be closed by a deeper one

  bool in_survey() const { return listed || closes; }
};

/// One run of one tool, ready to be placed.
struct DraftedRun {
  std::int32_t run = 0;
  bool misrun = false;
  std::vector<Draft> drafts;         ///< in the order of time
  std::vector<StationState> states;  ///< as known on the way, or adjusted: whichever is to be told
  std::vector<Waypoint> way;         ///< of the hole, in the order of time
  /// Stations asked for and passed that are not in `drafts` because no azimuth is known there: for
  /// good, or until the next north of a run that goes on.
  std::int64_t without_azimuth = 0, waiting_for_azimuth = 0;
  /// Root of the second moment of the depth scale's error, as the accelerometers tell it; 0: they
  /// do not.
  double depth_scale_found = 0;

  /// Of the depth scale as the survey counts it: what is found and not corrected is an error.
  double SigmaOfDepthScale(const ErrorPriors& errors) const {
    return std::max(errors.depth_scale_sigma, depth_scale_found);
  }
};

}  // namespace wellgyro
