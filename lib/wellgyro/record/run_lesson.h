#pragma once

#include <vector>

#include "wellgyro/record/error_source.h"
#include "wellgyro/record/tool_use.h"

namespace wellgyro {

/// What a run found of its tool's constant errors, and what was known of them before: as far as the
/// calibration that the run used left them.
struct RunLesson {
  ErrorVector errors = ErrorVector::Zero();
  ErrorMatrix cov_before = ErrorMatrix::Zero();  ///< of errors about zero; zero rows: no unknown
  ErrorMatrix cov = ErrorMatrix::Zero();         ///< of `errors`
  std::vector<ToolUse> uses;
};

}  // namespace wellgyro
