#pragma once

#include <span>

#include "wellgyro/base/export.h"
#include "wellgyro/record/run_lesson.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// The tool model with what runs that used it taught of its errors: its members moved, their
/// covariance and the errors it leaves (ErrorsLeft) smaller. What a run took for a constant and no
/// member is, or differs from one part of it to the next, counts as noise of the run. Errors are
/// taken to be the same on the bench and in every run: `lessons` of a tool that changed do not
/// belong together. Throws std::invalid_argument where the tool has no covariance of its members
/// (calibration/members.h).
WELLGYRO_EXPORT ToolCalibration Taught(ToolCalibration tool, std::span<const RunLesson> lessons);

}  // namespace wellgyro
