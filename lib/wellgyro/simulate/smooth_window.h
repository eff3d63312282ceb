#pragma once

namespace wellgyro {

/// A window that rises from 0 to 1 over `ramp_in`, stays there and falls to 0 over `ramp_out`,
/// within [0, length]; by quintic steps, so that its first two derivatives are continuous.
struct SmoothWindow {
  double integral = 0;  ///< from 0 to x
  double value = 0;
  double slope = 0;
};

/// Step from 0 to 1 over u in [0, 1]: u^3 (10 - 15 u + 6 u^2), its slope and its integral from 0.
constexpr SmoothWindow SmoothStep(double u) {
  return {.integral = u * u * u * u * (2.5 - u * (3 - u)),
          .value = u * u * u * (10 - u * (15 - 6 * u)),
          .slope = 30 * u * u * (1 - u) * (1 - u)};
}

/// The window at `x`. Ramps may be zero (then the window jumps there); their sum may not exceed
/// `length`.
constexpr SmoothWindow SmoothWindowAt(double x, double length, double ramp_in, double ramp_out) {
  const double whole = length - 0.5 * (ramp_in + ramp_out);
  if (x < 0) return {};
  if (x < ramp_in) {
    const SmoothWindow s = SmoothStep(x / ramp_in);
    return {.integral = ramp_in * s.integral, .value = s.value, .slope = s.slope / ramp_in};
  }
  if (x <= length - ramp_out) return {.integral = x - 0.5 * ramp_in, .value = 1, .slope = 0};
  if (x < length) {
    const SmoothWindow s = SmoothStep((length - x) / ramp_out);
    return {
        .integral = whole - ramp_out * s.integral, .value = s.value, .slope = -s.slope / ramp_out};
  }
  return {.integral = whole, .value = 0, .slope = 0};
}

}  // namespace wellgyro
