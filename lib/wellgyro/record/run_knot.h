#pragma once

#include "wellgyro/base/time.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/increment.h"

namespace wellgyro {

/// One knot of a run as the estimator takes it: the sensors' increment, joined with depth and rest.
struct RunKnot {
  Increment increment;
  UtcTime utc;            ///< of the end, by the clock tie
  AlongHole along;        ///< at the end
  bool still = false;     ///< the whole knot was at rest
  float temperature = 0;  ///< of the tool, at the end [degC]
  double unseen = 0;      ///< turn of the axis that no sensor saw, 1-sigma of this knot alone [rad]
  double var_unseen = 0;  ///< of the same, as it adds to that of the knots before [rad^2]
};

}  // namespace wellgyro
