#pragma once

#include <optional>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

struct FieldReference {
  double gravity = units::kStandardGravity;  ///< [m/s^2]
  double sigma_gravity = kSigmaGravity;      ///< [m/s^2]
  double latitude = 0;                       ///< [rad]
  std::optional<double> field;               ///< total [T]
  double sigma_field = 60e-9;                ///< [T]
  std::optional<double> dip;                 ///< downwards [rad]
  double sigma_dip = 1.4e-3;                 ///< [rad]
};

struct FieldCheckSetup {
  FieldReference reference;
  NoiseCoefficients gyro;
  ErrorPriors errors;
  double sigma_mag = 70e-9;  ///< of a flux density, each axis: MBX, MBY of SPE 67616 [T]
  double warn = 2;           ///< sigmas
  double fail = 3;           ///< sigmas
  struct Parity {
    double value = 0, sigma = 0;  ///< mean over the window [deg/h]
  };
  std::optional<Parity> parity;  ///< of four gyro channels
};

/// What one window at rest says of the sensors, each check against its own sigma, which holds the
/// window's noise, the priors and the reference's uncertainty: `gravity` |f| - g [m/s2];
/// `earth_rate` [deg/h]: with three gyro axes |w| - We, `earth_rate_vertical` w.up - We sin L, and
/// `earth_rate_horizontal`, what is left of w, less We cos L;
/// with two, the one residual that they leave whatever the azimuth: how far the measured rates lie
/// outside the ellipse of all azimuths (horizontal rate near vertical, vertical rate near
/// horizontal); `field` [nT] and `dip` [deg] where fluxgates and references are; `parity` [deg/h].
/// What cannot be checked is listed as not done.
WELLGYRO_EXPORT std::vector<Check> CheckWindow(const StillWindow& window,
                                               const FieldCheckSetup& setup);

/// `calibration_date` [d]: days that the calibration has still to run at the time of the data.
/// Data from before the calibration are `calibration_date_ahead`, minus the days between them.
/// Fails when it has expired, warns when the data are older than the calibration, not done without
/// dates.
WELLGYRO_EXPORT Check CheckCalibrationDate(const ToolCalibration& tool, UtcTime data);

}  // namespace wellgyro
