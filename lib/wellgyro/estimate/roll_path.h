#pragma once

#include <complex>
#include <optional>
#include <span>
#include <vector>

namespace wellgyro {

/// What the gyros across the hole say of the tool's heading in one knot, as x + i y.
struct RollReading {
  double seconds = 0;
  std::complex<double> read;     ///< in the knot's middle, without errors fixed in the tool [rad/s]
  std::complex<double> at_zero;  ///< the same as a tool of heading zero would read it [rad/s]
  bool tells = true;             ///< else the reading counts for nothing
  bool still = false;            ///< the rate is zero
  bool may_start = false;        ///< the rate may jump before this knot
  std::optional<double> expected_rate;  ///< of the roll [rad/s]
};

/// What a path of the roll is weighed by.
struct RollModel {
  std::complex<double> skew;       ///< the gyros read so much more, times the roll rate [1]
  double gyro_noise = 0;           ///< angle random walk [rad/sqrt(s)]
  double model_sigma = 0;          ///< of a reading, by what the model leaves out [rad/s]
  double rate_change = 0;          ///< scale of the rate's change from knot to knot [rad/s]
  double rate_change_started = 0;  ///< the same where the tool may start or stop [rad/s]
};

struct RollPath {
  std::vector<double> headings;  ///< at the begin of each knot [rad]
  std::vector<double> turns;     ///< in each knot [rad]
};

/// Headings and roll rates of knots in a row by the likeliest path over a grid of both (Viterbi,
/// 1967). A tool of heading h reads e^{-i h} times what one of heading zero does. The change of the
/// rate has Laplace's prior exp(-|x| / scale). A reading off by more than three sigmas costs no
/// more, so that a few that are wrong do not lead the path.
///
/// To half a step of the grid, 1.4 deg, up to 21 rpm. Memory is bounded by 8 MB, time is that of
/// 23 000 operations a knot.
RollPath LikeliestRoll(std::span<const RollReading> readings, const RollModel& model);

}  // namespace wellgyro
