#include "wellgyro/calibration/thermometer.h"

#include <algorithm>
#include <cmath>

namespace wellgyro {

Temperature TrueTemperature(const ThermometerCalibration& thermometer, double raw) {
  const ThermometerCalibration& m = thermometer;
  double read = m.offset + m.gain * raw;
  const bool inside = read >= m.min && read <= m.max;
  read = std::isfinite(read) ? std::clamp(read, m.min, m.max) : (m.min + m.max) / 2;
  const double above = std::max(0.0, read - m.knee);
  return {read + m.c0 + m.c1 * read + m.c2 * above * above, inside};
}

}  // namespace wellgyro
