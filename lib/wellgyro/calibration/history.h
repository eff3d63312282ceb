#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// One error source of a tool through its calibrations.
struct SourceHistory {
  std::string name;              ///< as CalibrationSources has it
  std::vector<double> changes;   ///< from each calibration to the next [SI]
  std::vector<double> sigmas;    ///< of the changes, by both calibrations' covariance [SI]
  double walk_per_sqrt_day = 0;  ///< what they ask for beyond that, as a random walk [SI]
  /// For a job so many days ahead, by a walk that the few changes do not exceed in five of six
  /// tools [SI]; none from one calibration, which knows of no change.
  std::optional<double> prior_sigma;
  bool shifted = false;        ///< the last change is beyond what chance reaches
  bool out_of_family = false;  ///< it walks unlike the other tools
};

struct ToolHistory {
  std::string asset_serial;
  std::vector<double> days;  ///< between calibrations
  std::vector<SourceHistory> sources;
  double reach = 0;  ///< sigmas that chance reaches in one of all the last changes
};

struct HistorySetup {
  double temperature = 20;    ///< [degC]
  double days_ahead = 30;     ///< of the job that priors are for
  double false_alarm = 0.01;  ///< of a sound tool
};

/// So many tools that have changed are a family.
inline constexpr std::size_t kToolsOfFamily = 5;

/// Histories of tools, one for every asset serial, from calibrations in any order. A change is that
/// of what calibrated samples say (biases, scales, misalignments, force terms at the temperature);
/// walks are by moments. Out of family: the mean square of a tool's changes a day is beyond five
/// robust sigmas of the others' (kToolsOfFamily and more) and beyond chance, chi-square of its
/// changes at `false_alarm` a tool. Throws std::invalid_argument for a calibration without a date,
/// or without the covariance of its members, or one that rests on a prior: its readings are
/// another's too.
WELLGYRO_EXPORT std::vector<ToolHistory> HistoriesOf(std::span<const ToolCalibration> calibrations,
                                                     const HistorySetup& setup);

}  // namespace wellgyro
