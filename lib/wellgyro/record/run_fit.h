#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/record/diagnosis.h"
#include "wellgyro/record/error_source.h"
#include "wellgyro/record/run_lesson.h"
#include "wellgyro/record/run_stretch.h"

namespace wellgyro {

/// How well the adjustment of a run as a whole fits what was measured, and what it found of the
/// tool's errors.
struct RunFit {
  /// Some of the residuals, by what they compare.
  enum Part {
    kInclination,  ///< gyros' turns against gravity on the way
    kForce,        ///< accelerometers against gravity and the motion along the hole
    kRest,         ///< rates at rest and the Earth's
    kAzimuth,      ///< azimuths given from outside, and from vague fixes
    kParts
  };
  /// Squares of residuals over their variances, and what is to be expected of their sum: their
  /// number less what the unknowns take up of them.
  struct Squares {
    double sum = 0;
    double freedom = 0;
  };

  std::string adjuster;        ///< what made it, in words, for run.toml
  double chi_square = 0;       ///< of all residuals, priors included
  int degrees_of_freedom = 0;  ///< residuals less unknowns
  bool converged = false;      ///< false: it gave up, and the run is as it was before
  /// Two azimuths fit nearly as well, differing by less than 9 in chi-square: none is given.
  bool ambiguous = false;
  std::array<Squares, kParts> parts;
  ErrorVector errors = ErrorVector::Zero();        ///< of the tool, as found
  ErrorVector sigma_errors = ErrorVector::Zero();  ///< of these; 0: has no prior
  /// Turn of the tool within a knot, beyond what its samples show, that twenty knots exceed [rad].
  double hidden_turn = 0;
  /// Azimuth from outside with which the run begins less that by all the rest of it; sigma 0: there
  /// is none, or nothing tells [rad].
  double closure_outside = 0, sigma_closure_outside = 0;
  std::optional<RunLesson> lesson;        ///< where its calibration has a covariance
  std::vector<RunStretch> stretches;      ///< of the run, in time
  std::optional<RunDiagnosis> diagnosis;  ///< where what adjusted the run made one
};

}  // namespace wellgyro
