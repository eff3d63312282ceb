#pragma once

#include <algorithm>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "wellgyro/estimate/setup.h"
#include "wellgyro/math/square.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Of a window of knots near vertical, in which the tool turns at one rate.
struct RollWindow {
  std::size_t node = 0;  ///< at its middle
  double rate = 0;       ///< of the roll, the likeliest [rad/s]
  /// What the gyros read wrongly and steadily, fixed in T: x + i y [rad/s].
  std::complex<double> steady;
  /// North is found: what turns with the tool is as large as the Earth's rate.
  bool finds_north = false;
  std::complex<double> bend_L;  ///< rate of the hole's bend where it is: north + i east [rad/s]
};

/// Information of the prior of a steady error, over that of one reading with `noise`; of one of
/// which a job states 0 a trillion.
inline double InformationOfSteady(double noise, double sigma) {
  return Square(noise / std::max(sigma, 1e-6 * noise));
}

/// The windows of a stretch of knots whose roll is hidden, 40 knots each, 10 apart; none of fewer
/// than 10 knots. While the axis leans and bends, what gyros and accelerometers read is a line at
/// the roll rate beside what they read wrongly and steadily. The rates are the likeliest sequence
/// over all windows. A swing of the roll within a window leaves the line its place, as its middle,
/// up to 30 deg. Of a bend that grows otherwise than evenly in a window it may tell a rate that is
/// wrong, and north by half a turn.
std::vector<RollWindow> RollWindowsOf(std::span<const RunKnot> knots, const EstimateSetup& setup);

}  // namespace wellgyro
