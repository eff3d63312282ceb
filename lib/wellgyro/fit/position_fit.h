#pragma once

#include <optional>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/base/units.h"
#include "wellgyro/calibration/bench_axes.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/calibration/fit_report.h"

namespace wellgyro {

struct TwentyFourPositionSetup {
  BenchAxes axes = BenchAxes::kTrade;
  double gravity = 1;              ///< local, in standard g; supplied, never measured by itself [g]
  double settle_tolerance = 1e-4;  ///< of readings that repeat [V]
  std::optional<double> sigma;     ///< of a settled mean [V]
  int max_degree = 3;              ///< of the polynomials in temperature, where there are several
  double min_temperature_swing = 20;  ///< below it no polynomial is fitted [degC]
};

/// Three accelerometers, each axis up and down at four rotations about the vertical (method of
/// US 11519264 B1): columns axis, dir, rot_deg, channel, volt and, where there are several runs,
/// T_C; the readings of a position in the order of time. "+1 g with the axis up".
///
/// M of each position is Settle's, P the mean of its four rotations, V = Vb + S u + K2 u_own^2 by
/// least squares; a tilt of the bench, which turns with the rotation, is estimated for every axis
/// and direction and does not reach Vb. S is freed of the tilt's cosine. Several temperatures:
/// polynomials of Vb and S in one fit, their degree by F test, at most two less than there are
/// temperatures. Result: `S_V_per_g`, `Vb_V`, `K2_V_per_g2`, `angle_deg` between the sensitive
/// axes, `P_V`, `M_V` (by axis, up before down, rotation; a column a channel), `tilt_deg`, and for
/// several temperatures `per_T`. Faults name positions that are missing or have not settled.
WELLGYRO_EXPORT Result<BenchCalibration> FitTwentyFourPositions(
    const BenchTable& data, const TwentyFourPositionSetup& setup);

struct SixPositionSetup {
  BenchAxes axes = BenchAxes::kTrade;
  double gravity = units::kStandardGravity;  ///< where the table has no axb, ayb, azb [m/s^2]
  bool gravity_stated = false;               ///< and where it has them, they must agree to 1e-4
  bool second_order = true;     ///< estimate k2; else the bias is that of each axis's own pair
  std::optional<double> sigma;  ///< of pulses counted in a position [1]
  /// Of the fixture, each position anew; needs `sigma` [rad].
  std::optional<double> tilt_sigma;
};

/// Three accelerometers with pulse outputs, each axis up and down, once or repeated with the tool
/// rotated: columns axis, sign, T_s, Nx, Ny, Nz and, where the fixture is not exact, axb, ayb, azb
/// (specific force there [m/s^2]).
///
/// N/T = k (a0 + a + k2 a_own^2 + E a). With k2, a0 is read from the positions where the axis lies
/// level: free of k2, but a tilt of the fixture enters at first order (1 arcsec is 4.85 ug);
/// without it a0 is read from the axis's own pair: free of tilt to first order, but k2 g too large.
/// Rows are weighted by tilt and counting noise, estimated from repeats where not given; throws
/// std::invalid_argument for a tilt without the noise. Result:
/// `k_pulse_per_s_per_mps2`, `a0_mps2`, `E_rad`, `k2_g_per_g2`.
WELLGYRO_EXPORT Result<BenchCalibration> FitSixPositions(const BenchTable& data,
                                                         const SixPositionSetup& setup);

}  // namespace wellgyro
