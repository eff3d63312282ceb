#pragma once

#include <optional>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/bench_axes.h"

namespace wellgyro {

/// The Earth's rate against the stars that benches are compared with, 1.00273781191135448 turns a
/// day [rad/s]; WGS 84's own figure is 2e-8 of it less.
inline constexpr double kBenchEarthRate = 7.292115146706979e-5;

/// What stands around a bench.
struct BenchReference {
  BenchAxes axes = BenchAxes::kTrade;
  double gravity = 1;  ///< in the unit of the accelerometers' table, g as a rule
  /// The same [m/s^2], for what the tool model says.
  double gravity_mps2 = units::kStandardGravity;
  std::optional<double> latitude;  ///< geodetic [rad]
  std::optional<double> field;     ///< total [nT]
  std::optional<double> dip;       ///< downwards [rad]
  double declination = 0;          ///< of the field against the azimuths of the table [rad]
};

}  // namespace wellgyro
