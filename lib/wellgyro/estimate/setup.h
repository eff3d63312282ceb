#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "wellgyro/earth/earth.h"
#include "wellgyro/estimate/cause.h"
#include "wellgyro/record/error_covariance.h"
#include "wellgyro/record/noise.h"

namespace wellgyro {

/// An azimuth known from outside the run's own sensors.
struct AzimuthTie {
  std::size_t node = 0;  ///< at whose instant it holds
  double azimuth = 0;    ///< true [rad]
  double sigma = 0;      ///< [rad]
  bool of_mark = false;  ///< of the reference mark, for a tool near vertical; else of the axis
};

/// A north of the run: the Earth's rate at rest in knots [begin, end), or an azimuth from outside
/// at node `end`.
struct NorthAt {
  std::size_t begin = 0, end = 0;
  bool outside = false;
};

/// What the estimator must know of the tool and the place before the first knot.
struct EstimateSetup {
  NoiseCoefficients gyro;  ///< of every axis
  ErrorPriors errors;
  /// Of the errors that a calibration left; `errors` are constants beside it.
  std::optional<ErrorCovariance> cov_errors;
  Site site;  ///< of node 0; latitude and gravity are carried along the path
  double sigma_gravity = kSigmaGravity;  ///< of the Earth model [m/s^2]
  /// Of its growth with depth: a Bouguer plate counted twice, whose density is 2670 kg/m^3 within 9
  /// % [m/s^2 per m].
  double sigma_gravity_gradient = 2e-7;
  /// Of the gyros' biases, by which they change over `cov_errors`' span of temperature beside what
  /// that states [rad/s].
  double sigma_bias_by_warmth = 0;
  /// Of the depth marks' scale, as an unknown of the run; 0: it is none, and depth is what they
  /// say.
  double sigma_depth_scale = 0;
  bool third_axis = false;  ///< some knot has one
  /// The roll swings at this angular frequency [rad/s]; absent, or where a third axis measures it:
  /// it walks.
  std::optional<double> swing;
  bool may_swing = true;  ///< a swing is tried where the roll shows one
  std::vector<AzimuthTie> ties;
  std::vector<NorthAt> norths;     ///< whose closures are wanted
  std::vector<CauseSpec> causes;   ///< that are looked for in the solution; none: no diagnosis
  double false_alarm_rate = 1e-3;  ///< of the diagnosis
};

}  // namespace wellgyro
