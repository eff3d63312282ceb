#pragma once

namespace wellgyro::increment {

/// Variance of where a knot's mean force stands about the axis, over that of the accelerometers'
/// mean: the roll by which the force is turned back follows the noise of the same samples.
///
/// The smoothing spline of a rate that walks by q from phases of white noise R passes
/// H(w) = 1 / (1 + (w / c)^4), c = (q / R)^(1/4). What it passes moves the mean of the forces less
/// that of the roll about the line through its ends, which the estimator takes back, so that
///   g(a) = (1 / pi) int_0^inf (s - H(x / T) (s - cos x/2))^2 dx, s = sin(x/2) / (x/2), a = c T:
/// 1 of an even roll, 0.63 at a = 4, from 10 on 0.1326 a + 0.06. `blocks`: phases in the knot,
/// which end the integral at x = pi blocks and with it g at half their number; of fewer than
/// four 1.
double LateralVariance(double a, double blocks);

}  // namespace wellgyro::increment
