#include "wellgyro/calibration/thermometer.h"

#include "wellgyro/calibration/thermometer_internal.h"

namespace wellgyro {

Temperature TrueTemperature(const ThermometerCalibration& thermometer, double raw) {
  Temperature temperature;
  FindTrueTemperature(thermometer, raw, temperature.value, temperature.inside);
  return temperature;
}

}  // namespace wellgyro
