#pragma once

#include <span>
#include <vector>

#include "wellgyro/survey/hole/well_uncertainty.h"

namespace wellgyro {

/// How a hole bends between stations. Its tangent's components across are an intrinsic random
/// function of order 1 with the generalised covariance -kink |h| / 2 + wander |h|^3 / 12 (Matheron,
/// Advances in Applied Probability 5, 1973): curvature that is white at the stations' spacing, as
/// by slides and ledges, and curvature that walks at random.
struct HoleRoughness {
  double kink = 0;    ///< [rad^2/m]
  double wander = 0;  ///< [rad^2/m^3]

  /// Covariance of how far each component is from the spline through the stations at two fractions
  /// of a leg of `length` [rad^2]; 0 between different legs. In the middle it is that of the cubic
  /// through the four stations around, evenly spaced: 66/256 kink h + 3/256 wander h^3. Towards the
  /// ends it falls as a bow does, f (1 - f): the curvature of a hole is finite.
  double OffSpline(double length, double fraction, double other) const;
};

/// A listing to tell it from.
struct RoughListing {
  const SurveyedWell* well = nullptr;
  /// Of each station's direction in either way across: what is its own [rad^2].
  std::vector<double> noise;
};

/// From listings of one hole in [begin, end]: how far each station lies off the arc between its
/// neighbours, by maximum likelihood beside the stations' noise. Zero where no listing has five
/// stations there.
HoleRoughness RoughnessOf(std::span<const RoughListing> listings, double begin, double end);

}  // namespace wellgyro
