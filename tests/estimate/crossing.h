#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/record/run_knot.h"

namespace wellgyro::test {

/// How a tool rolls: steadily or by turns, and swinging about that.
struct CrossingRoll {
  double rpm = 0;
  double pause = 0;      ///< as long as it rolls, and rests before it rolls again; 0: no rest [s]
  double swing_deg = 0;  ///< amplitude of the swing
  double swing_period = 23;  ///< [s]
  double phase_walk = 0;     ///< random walk of the swing's phase [rad/sqrt s]
};

/// A hole that turns at a constant rate past vertical, 12 deg in 9 minutes at its closest so far
/// from it, logged at a constant speed by a tool that rolls.
struct Crossing {
  double closest_deg = 0.05;
  CrossingRoll roll;
  double speed = 0.6;  ///< [m/s]
  double seconds = 540;
  double latitude_deg = 60;
  double gravity = 9.8191;  ///< [m/s^2]

  struct Motion {
    Eigen::Matrix3d R_LT;
    Eigen::Vector3d w_IT_T, f_T;
  };
  Motion At(double t) const;
  /// The tool's roll about the hole and its rate [rad, rad/s].
  struct Spin {
    double angle = 0, rate = 0;
  };
  Spin SpinAt(double t) const;
  /// Draws the walk of the swing's phase.
  void DrawPhase(std::uint64_t seed);
  /// Means over each period of `hz`, by Gauss's three points.
  struct Samples {
    double hz = 10;
    std::vector<Eigen::Vector3d> w, f;
  };
  Samples Sample(double hz) const;

  std::vector<double> phase;  ///< of the swing beyond its steady phase, every two seconds [rad]
};

/// Errors of one tool: what a seed draws.
struct ToolDraw {
  double arw = 0.01 / 57.29577951308232 / 60;    // [rad/sqrt s]
  double bias = 0.1 / 57.29577951308232 / 3600;  // [rad/s]
  double accel_bias = 1e-4 * 9.80665;            // [m/s^2]
  double accel_noise = 5e-5 * 9.80665;           // [m/s^2/sqrt Hz]
};
void AddErrors(const ToolDraw& draw, std::uint64_t seed, Crossing::Samples& samples);

/// Knots of `seconds` by the inertial roll `psi` at the edges of the samples: the sums of Increment
/// written out plainly.
std::vector<RunKnot> ReferenceKnots(const Crossing::Samples& samples,
                                    const std::vector<double>& psi, double seconds, double speed);

/// The true inertial roll at the edges of the samples.
std::vector<double> TrueRoll(const Crossing& crossing, double hz);

}  // namespace wellgyro::test
