#pragma once

#include <optional>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/calibration/fit_report.h"
#include "wellgyro/calibration/trigonometric.h"
#include "wellgyro/fit/bench_reference.h"

namespace wellgyro {

struct AffineSetup {
  BenchReference reference;
  enum class Order { kNone, kOwn, kFull } order = Order::kNone;  ///< second order of accelerometers
  std::optional<double> sigma_accel;                             ///< of a reading [its unit]
  std::optional<double> sigma_mag;                               ///< of a reading [its unit]
  double tilt_sigma = 0;  ///< of each position's attitude, about each axis [rad]; needs the sigmas
};

/// Accelerometers, and magnetometers where the table has them and field and dip are given, at
/// known attitudes: columns inc, az, tf [deg], Gx.. (gravity-signed) or fx.. or vx.., Mx.. or mx...
///
/// v = b + S u (+ K2 q(u)), least squares; 4 attitudes that span space, 5 and more with second
/// order, 45 deg ones for products. Result: `S_G`, `b_G`, `K2_G`, `S_M`, `b_M_nT`.
WELLGYRO_EXPORT Result<BenchCalibration> FitAffine(const BenchTable& data,
                                                   const AffineSetup& setup);

struct OrthogonalitySetup {
  BenchReference reference;           ///< field and dip are needed
  bool free_frequency = false;        ///< of the trigonometric model
  std::optional<double> sigma_accel;  ///< [g]
  std::optional<double> sigma_mag;    ///< [nT]
};

struct OrthogonalityFit {
  BenchCalibration calibration;  ///< the affine model
  AffineModel affine;
  TrigonometricModel trigonometric;
  std::optional<OrthogonalityCheck> check;  ///< where the table has rows of seq 0
};

/// Three accelerometers [g, gravity-signed] and three fluxgates [nT] over the sequences of the
/// trigonometric method: columns seq, inc, az, tf [deg], Gx..Mz; seq 1 at toolface 90 (Gx, Mx), 2
/// at toolface 0 (Gy, My), 3 at azimuth 270 and inclination 90 (Gz, Mz), 0 for verification.
///
/// Both models from the same readings: the trigonometric one, each channel's error against its own
/// sequence, frequency 1 or free (several starts, kept only where an F test rejects 1; amplitudes
/// not negative, phases in (-pi, pi]), and the affine one over all channels of all sequences, which
/// is the one to use. Result: `E_G`, `b_G`, `E_M`, `b_M_nT` with raw = (1 + E) ideal + b; `x_kj`.
WELLGYRO_EXPORT Result<OrthogonalityFit> FitOrthogonality(const BenchTable& data,
                                                          const OrthogonalitySetup& setup);

}  // namespace wellgyro
