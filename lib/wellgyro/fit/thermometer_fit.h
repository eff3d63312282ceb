#pragma once

#include <optional>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/calibration/fit_report.h"

namespace wellgyro {

struct ThermometerFitSetup {
  double knee = 175;            ///< where the readings bend [degC]
  bool fit_knee = false;        ///< find the knee too; needs readings on both sides
  std::optional<double> sigma;  ///< of a reading against the references' mean [degC]
};

/// Thermometer against others: columns t_m and any number of ref..., a row a temperature [degC].
///
/// mean(ref) - t_m = c0 + c1 t_m + c2 max(0, t_m - knee)^2, least squares. Without readings beyond
/// the knee c2 is left at zero and a remark says so; a Fault where the knee is to be found and
/// there is none. The range is that of the readings. Result: `c` (three numbers) and `knee_C`.
WELLGYRO_EXPORT Result<BenchCalibration> FitThermometer(const BenchTable& data,
                                                        const ThermometerFitSetup& setup);

}  // namespace wellgyro
