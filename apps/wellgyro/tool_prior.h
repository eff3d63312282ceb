#pragma once

#include <string>
#include <vector>

#include "wellgyro/base/result.h"
#include "wellgyro/calibration/uncertainty_budget.h"
#include "wellgyro/io/toml/calibration_file.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro::apps {

/// A tool, and the covariance of the members that the bench found by its sources.
struct Calibrated {
  ToolCalibration tool;
  std::vector<std::string> members;
  CovarianceParts by_source;
};

/// The bench's tool joined with what a tool file says was known of it before, which joins the
/// inputs of `file`; its result remains the bench's alone. Refused where the two are of different
/// tools, rest on the same readings or contradict each other.
Result<Calibrated> WithPrior(const std::string& name, Calibrated tool, CalibrationFile& file);

}  // namespace wellgyro::apps
