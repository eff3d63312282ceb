#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/fit/gyro_readings_internal.h"
#include "wellgyro/fit/tool_fit.h"

namespace wellgyro {

/// A channel of the tool: of the accelerometers, or of the gyros.
struct ToolChannel {
  std::string name;
  bool is_gyro = false;
  int axis = 0;  ///< nominal input axis
};

/// How a stand holds the tool, as the table has it [rad].
struct StandAngles {
  double inclination = 0, azimuth = 0, toolface = 0;
};

/// One reading of a bench.
struct ToolRow {
  int table = 0, line = 0;
  int mount = -1;      ///< 3 table + axis on a rate table, -1 at rest
  StandAngles stated;  ///< at rest
  Eigen::Matrix3d R_BL = Eigen::Matrix3d::Identity();  ///< at rest: by these, level to bench
  Eigen::Vector3d across_L = Eigen::Vector3d::Zero();  ///< at rest: inclination grows about it
  double rate = 0;                                     ///< on a rate table [deg/h]
  double temperature = 0, heating = 0;                 ///< [degC], [degC/s]
  double branch = 0;                                   ///< +1 while heating, -1 while cooling
  double time = 0;                                     ///< from -1 to 1 through its table
  std::vector<int> channels;                           ///< that were read
  Eigen::VectorXd v;                                   ///< what they read
};

/// Sets the attitude of a row at rest.
void SetAttitude(BenchAxes axes, const StandAngles& stated, ToolRow& row);

struct ToolReadings {
  std::vector<ToolChannel> channels;  ///< accelerometers first
  std::vector<Rotor> rotors;          ///< places among the gyros
  int n_accel = 0, n_gyro = 0, n_tables = 0;
  bool gravity_signed = false, has_temperature = false;
  double middle = 20, half_range = 1;  ///< of the temperatures [degC]
  double coldest = 0, hottest = 0;
  std::vector<ToolRow> rows;
};

/// Rows of all tables. Faults as the single methods give them, and where two tables name other
/// channels.
Result<ToolReadings> ReadTool(std::span<const BenchTable> tables, const ToolFitSetup& setup);

}  // namespace wellgyro
