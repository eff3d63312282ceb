#pragma once

#include <optional>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/calibration/fit_report.h"
#include "wellgyro/fit/bench_reference.h"

namespace wellgyro {

/// What a gyro feels of the specific force.
enum class GyroForceModel {
  kDualAxis,  ///< dynamically tuned: M and Q shared by the two channels of a rotor, anisoelastic
  kFull,      ///< any of three components, for vibrating and MEMS gyros
  kNone,      ///< fibre and ring lasers
};

struct GyroFitSetup {
  BenchReference reference;  ///< the latitude is needed
  /// Absent: gyro by gyro, dual-axis of channels whose names carry a rotor (m_x1, m_y1), full of
  /// others.
  std::optional<GyroForceModel> force;
  bool fit_north = false;       ///< the fixture's north offset too
  std::optional<double> sigma;  ///< of a reading at rest [deg/h]
  /// Of a reading on the rate table [deg/h]; absent, as its own residuals scatter.
  std::optional<double> sigma_table;
};

/// Gyros at rest in many attitudes against the Earth's rate, and on a rate table: columns inc, az,
/// tf [deg] and a column m_... a channel [deg/h] (two to four), fx, fy, fz [g] where the attitudes
/// do not say all; `table` (columns axis, rate_deg_s and the same channels, the axis pointing up)
/// is joined where given. Either may be without rows.
///
/// m = b + U w + G f + N f_in f_spin, w and f in the bench's axes. For a rotor with inputs a before
/// c (in the order x, y, z) and spin s: m_a = ... + M f_a + Q f_c + N f_a f_s, m_c = ... + M f_c -
/// Q f_a + N' f_c f_s. Attitudes at every 45 deg of inclination, 90 deg of azimuth and 60 deg of
/// toolface see everything; toolfaces at multiples of 90 deg do not see N, and it is left out. A
/// wrong latitude shows beside a rate table alone, and is told. Result: `b_degh`, `U`,
/// `G_degh_per_g`, `aniso_degh_per_g2`, `MQ` (M, Q of each rotor); with four channels
/// `parity_rms_degh`.
WELLGYRO_EXPORT Result<BenchCalibration> FitGyro(const BenchTable& rest, const BenchTable& table,
                                                 const GyroFitSetup& setup);

}  // namespace wellgyro
