#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/calibration/bench_axes.h"
#include "wellgyro/calibration/fit_report.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// What a bench does not say of a tool. What is absent stays as the tool has it.
struct ToolUpdate {
  BenchAxes axes = BenchAxes::kTrade;        ///< of the bench, for the roll test's axis
  std::optional<std::vector<int>> channels;  ///< places in raw_batch_t of the group's channels
  std::optional<std::vector<double>> unit_per_count;  ///< of each, or one of all
  std::optional<Eigen::Matrix3d> R_TS;     ///< the sensors' axes in T, in place of the bench's
  int thermometer = 0;                     ///< place in ToolCalibration::thermometers
  std::optional<int> thermometer_channel;  ///< place in raw_batch_t
  std::optional<std::string> asset_serial, sensor_serials;
  std::optional<UtcTime> calibrated, expires;
};

/// Takes what a bench found into the tool model: its groups of sensors with their covariance, its
/// thermometer, the housing's axis (accelerometers and magnetometers turn), and what is left of
/// errors. A new group without channels given takes the first places that are free. Throws
/// std::invalid_argument when a list has another length than the group, or the roll test comes
/// before the accelerometers.
WELLGYRO_EXPORT ToolCalibration Updated(ToolCalibration tool, const BenchCalibration& bench,
                                        const ToolUpdate& update);

}  // namespace wellgyro
