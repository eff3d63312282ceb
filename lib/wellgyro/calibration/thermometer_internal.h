#pragma once

#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// TrueTemperature of one reading or of several side by side; inside: all bits or one where the
/// reading lies in the calibrated range, else 0.
template <class Number, class Inside>
[[gnu::always_inline]] inline void FindTrueTemperature(const ThermometerCalibration& m,
                                                       const Number& raw, Number& value,
                                                       Inside& inside) {
  const Number none{}, min = m.min - none, max = m.max - none, middle = (m.min + m.max) / 2 - none;
  Number read = m.offset + m.gain * raw;
  inside = (read >= min) & (read <= max);
  const auto number = read - read == none;  // neither infinite nor nan
  const Number above_min = read < min ? min : read;
  const Number held = max < above_min ? max : above_min;
  read = number ? held : middle;
  const Number beyond = read - m.knee;
  const Number above = none < beyond ? beyond : none;
  value = read + m.c0 + m.c1 * read + m.c2 * above * above;
}

}  // namespace wellgyro
