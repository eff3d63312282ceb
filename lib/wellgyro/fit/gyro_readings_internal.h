#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/fit/gyro_fit.h"

namespace wellgyro {

/// A channel m_x1: input axis x, rotor 1; m_x: no rotor (-1).
struct GyroChannel {
  std::string name;
  int axis = 0, rotor = -1;
};

/// Two channels of one rotor.
struct Rotor {
  int a = 0, c = 0;  ///< channels, input axes in the order x, y, z
  int spin = 2;      ///< axis
};

/// Readings at rest and on the table, one row each.
struct GyroReadings {
  std::vector<GyroChannel> channels;
  std::vector<Rotor> rotors;
  std::vector<int> lines;  ///< those of the table behind those at rest
  std::vector<char> on_table;
  bool joined = false;             ///< some at rest, some on the table
  Eigen::MatrixX3d w;              ///< true rate [deg/h], bench axes
  Eigen::MatrixX3d w_level;        ///< its level part, which turns with the fixture's north offset
  Eigen::MatrixX3d w_north;        ///< its change with that offset [deg/h per rad]
  Eigen::MatrixX3d w_by_latitude;  ///< change of w with the latitude [deg/h per rad]
  Eigen::MatrixX3d f;              ///< specific force [g]
  double f_off = 0;   ///< by how much the table's own lies beside its inc and tf, rms [g]
  Eigen::MatrixXd m;  ///< readings [deg/h], a column a channel
  int rows() const { return static_cast<int>(lines.size()); }
};

/// The channels of a table, in the order of its columns m_...; two to four.
Result<std::vector<GyroChannel>> GyroChannelsOf(const BenchTable& data);
std::vector<Rotor> RotorsOf(const std::vector<GyroChannel>& channels);

Result<GyroReadings> ReadGyros(const BenchTable& rest, const BenchTable& table,
                               const BenchReference& reference);

}  // namespace wellgyro
