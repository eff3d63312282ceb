#pragma once

#include "wellgyro/depth/cable.h"
#include "wellgyro/depth/depth_track.h"
#include "wellgyro/survey/run/run_book.h"
#include "wellgyro/survey/verdict/checks.h"

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
