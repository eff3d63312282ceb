#pragma once

#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/plan/expected_end.h"
#include "wellgyro/plan/plan_case.h"

namespace wellgyro {

/// The formation's temperature and what the tool is calibrated for.
struct PreflightHeat {
  double at_surface = 10;      ///< [degC]
  double gradient = 0;         ///< with depth [degC/m]; 0: not known
  double calibrated_to = 1e3;  ///< of the tool, the lower of gyros and accelerometers [degC]
};

/// Of the tool's calibration and of the run, as far as they are told.
struct PreflightDates {
  std::optional<UtcTime> calibrated, expires, run;
};

/// What makes this tool, on this way, in this well a doubtful choice, a sentence each; none where
/// nothing does: where the Earth's rate shows north badly (near a pole; near horizontal east-west,
/// below a fifth of its horizontal part), where the high side is no hold (below 1 deg), a drift
/// over the run above the bias' own sigma, errors stated as none, depth that alone makes half of
/// the ellipse, heat beyond the calibration, and a calibration that runs out before the run, is
/// younger than it, or states no end. `expected`: with the stops that are planned.
WELLGYRO_EXPORT std::vector<std::string> Preflight(const PlanCase& c, const ExpectedEnd& expected,
                                                   const PreflightHeat& heat,
                                                   const PreflightDates& dates = {});

}  // namespace wellgyro
