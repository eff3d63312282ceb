#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_axes.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/fit/bench_reference.h"

namespace wellgyro {

/// Rows of a table with their attitudes and what its sensors read.
struct AttitudeTable {
  std::vector<int> lines;
  Eigen::VectorXd inclination, azimuth, toolface;  ///< [rad]
  bool has_attitude = false;
  Eigen::MatrixX3d accel, mag;  ///< as read; no rows where the table has none
  std::vector<std::string> accel_channels, mag_channels;
  bool gravity_signed = false;  ///< accel gives gravity, else specific force

  int rows() const { return static_cast<int>(lines.size()); }
  /// What ideal accelerometers give in row i, in the unit of `gravity` and with the readings' sign.
  Eigen::Vector3d IdealAccel(int i, const BenchReference& reference) const;
  /// The field in row i [nT].
  Eigen::Vector3d IdealMag(int i, const BenchReference& reference) const;
};

/// Attitudes from inc, az, tf (or inc_true ...); accelerometers Gx.. or ax.. (gravity-signed), or
/// fx.. or vx.. (specific force); magnetometers Mx.. or mx... What is needed and missing is a
/// Fault.
struct AttitudeNeeds {
  bool attitude = false, accel = false, mag = false;
};
Result<AttitudeTable> ReadAttitudeTable(const BenchTable& data, const AttitudeNeeds& needs);

/// Places of channels that the table has.
std::vector<int> ColumnsOf(const BenchTable& data, const std::vector<std::string>& channels);

/// Repeated rows or readings, and frozen channels, of a whole table.
std::optional<Fault> BadReadings(const BenchTable& data, const AttitudeTable& table);

}  // namespace wellgyro
