#pragma once

namespace wellgyro {

/// How a tool was for a part of a run, as far as the errors of its calibration depend on it.
struct ToolUse {
  double share = 1;        ///< of the run
  double temperature = 0;  ///< [degC]
  double heating = 0;      ///< dT/dt [degC/s]
  double axial_force = 0;  ///< specific force along z of T [m/s^2]
};

}  // namespace wellgyro
