#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "wellgyro/attitude/station_state.h"
#include "wellgyro/depth/depth_motion.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/survey/intake/sample_watch.h"
#include "wellgyro/survey/run/provisional.h"
#include "wellgyro/survey/run/run_survey.h"

namespace wellgyro {

/// One run of one tool, and what watches it.
struct ToolRun {
  std::unique_ptr<RunSurvey> survey;
  std::unique_ptr<ProvisionalPath> provisional;
  std::size_t solutions = 0;  ///< of the run, when that path began
  std::unique_ptr<SampleWatch> watch;
  std::unique_ptr<DepthMotion> motion;
  // As of the last Adjust:
  std::vector<StationState> adjusted;
  std::size_t adjusted_drafts = 0;
  std::vector<AttitudeSample> attitude;  ///< smoothed, of every knot
};

}  // namespace wellgyro
