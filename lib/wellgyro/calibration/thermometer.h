#pragma once

#include "wellgyro/base/export.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

struct Temperature {
  double value = 0;     ///< true temperature [degC]
  bool inside = false;  ///< the reading lies in the calibrated range
};

/// The true temperature where the thermometer's channel gives `raw`. Readings beyond the calibrated
/// range are taken at its end and marked; a reading that is no number as the middle of the range.
WELLGYRO_EXPORT Temperature TrueTemperature(const ThermometerCalibration& thermometer, double raw);

}  // namespace wellgyro
