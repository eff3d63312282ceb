#pragma once

#include <optional>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/calibration/fit_report.h"
#include "wellgyro/fit/bench_reference.h"

namespace wellgyro {

struct RollTestSetup {
  BenchReference reference;
  std::optional<double> sigma;  ///< of a reading [its unit]
};

/// The housing's axis in the accelerometers' frame: columns set, fx, fy, fz (calibrated), rolled in
/// V-blocks at several inclinations, a set each. Along the axis a set reads one value, whatever the
/// roll: the axis is the direction in which the readings about their set's mean vary least. Two
/// sets of rolls, or one right round where the tool lies level. Result: `axis_in_sensor`, pointing
/// with the sensors' z; `misalignment_deg` between them.
WELLGYRO_EXPORT Result<BenchCalibration> FitRollTest(const BenchTable& data,
                                                     const RollTestSetup& setup);

}  // namespace wellgyro
