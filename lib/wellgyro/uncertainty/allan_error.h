#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/uncertainty/error_model.h"
#include "wellgyro/uncertainty/propagate.h"
#include "wellgyro/uncertainty/survey_point.h"

namespace wellgyro {

/// A continuous gyro on its way down a well.
struct AllanRun {
  NoiseCoefficients noise;  ///< of one axis
  GyroAxes axes = GyroAxes::kXy;
  double speed = 0;  ///< along hole [m/s]
  /// A section of continuous survey opens where the hole builds through this inclination and ends
  /// where it drops through it again [rad]; negative: it opens at the first station and stays open.
  double initialise = 0;
  double sigma_azimuth = 0;  ///< of the fix that opens a section [rad]
};

/// What one coefficient makes of azimuth and position, per station.
struct AllanTerm {
  std::string term;                      ///< "ALLAN-N" and so on
  std::vector<double> var_azimuth;       ///< [rad^2]; 0 outside sections
  std::vector<Eigen::Matrix3d> cov_p_W;  ///< (north, east, down) [m^2]
};

struct AllanUncertainty {
  std::vector<double> var_azimuth;
  std::vector<Eigen::Matrix3d> cov_p_W;
  std::vector<AllanTerm> terms;  ///< those whose coefficient is not zero
  std::optional<Refusal> refusal;
};

/// Covariance of azimuth and position that the drift of a gyro makes, exactly as its Allan
/// coefficients say, correlated along hole as the processes are.
///
/// The azimuth error obeys dA/dt = a w, a = 1/sin I for two axes, 1/cos I for one, 1 for three,
/// with w the rate error (math/drift.h); the position error is the integral of A (-sin I sin A, sin
/// I cos A) along the arcs between the stations. Both are integrated along the arc, in steps of at
/// most 1 deg of dogleg and 0.4 % of a: stations may be added on the path at will (1e-4 of a
/// sigma). At a fix the azimuth error is new; rate random walk and ramp count from it; a constant
/// bias and a slope are the same in every section; a Gauss-Markov bias goes on. Quantisation is a
/// step at the fix and one at the station. Time is MD over speed; the Earth rate's feedback through
/// the azimuth error and the turning of the tool about its axis are left out (the latter makes less
/// of B, K, R).
///
/// O(stations). Refuses where 1/a is below 0.01. Throws std::invalid_argument for a survey as
/// PropagateErrors does, a speed not above 0, and coefficients that are negative or not finite.
WELLGYRO_EXPORT AllanUncertainty AllanErrors(std::span<const SurveyPoint> survey,
                                             const AllanRun& run);

/// The recursive form that SPE 90408 prints, for comparison, all systematic within a section: with
/// dt a leg's time and a = 1 / f of its mean inclination,
///   N: h^2 += a^2 dt (GRW),   B: h += a dt (GD),   K: h^2 += a^2 dt^3 / 3,   R: h += a dt^2 / 2.
/// The last two follow the paper's pattern for the other two Allan coefficients. They forget at
/// every station what the rate has become: over n equal legs K comes out n and R n times too small.
struct PrintedAllan {
  ErrorModel model;
  std::vector<std::string> left_out;  ///< coefficients that are not zero and have no printed form
};
WELLGYRO_EXPORT PrintedAllan PrintedAllanModel(const AllanRun& run);

}  // namespace wellgyro
