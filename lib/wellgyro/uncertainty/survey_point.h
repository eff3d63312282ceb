#pragma once

namespace wellgyro {

/// One station of a well as the error models see it.
struct SurveyPoint {
  double md = 0;           ///< [m], strictly increasing
  double inclination = 0;  ///< [rad], [0, pi]
  double azimuth = 0;      ///< in the survey's own frame: true, or grid with a convergence [rad]
  double tvd = 0;          ///< below the depth datum [m]
};

}  // namespace wellgyro
