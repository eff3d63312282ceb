#pragma once

#include "wellgyro/depth/cable.h"
#include "wellgyro/depth/depth_track.h"
#include "wellgyro/survey/checks.h"
#include "wellgyro/survey/run_book.h"

namespace wellgyro {

/// What the tools of a string have in common. All of it must outlive who refers to it.
struct StringRecords {
  const DepthTrack& track;
  const MarksRefused& refused;
  CableMarks& marks;
  RunBook& book;
  const double& sigma_utc;  ///< see Surveyor::TieClock [s]
};

}  // namespace wellgyro
