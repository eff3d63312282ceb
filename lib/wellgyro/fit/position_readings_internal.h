#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"

namespace wellgyro {

/// One channel at one of the 24 positions.
struct PositionReading {
  double volt = 0;
  int line = 0;  ///< of its first reading
};

/// 24 positions at one temperature: settled means M.
struct PositionRun {
  double temperature = 0;  ///< mean [degC]
  bool has_temperature = false;
  /// Change through the readings of a position that noise does not explain, rms of all positions;
  /// of runs of less than eight readings, from which no transient can be taken [V].
  double drift = 0;
  double step = 0;  ///< of the converter, of which all readings are multiples; 0: none is seen [V]
  /// By axis, direction (up, down), rotation and channel.
  std::array<PositionReading, 72> readings;

  static std::size_t At(int axis, int down, int quarter, int channel) {
    const int at = ((axis * 2 + down) * 4 + quarter) * 3 + channel;
    return static_cast<std::size_t>(at);
  }
  const PositionReading& Of(int axis, int down, int quarter, int channel) const {
    return readings[At(axis, down, quarter, channel)];
  }
  /// Mean of the four rotations.
  double P(int axis, int down, int channel) const;
  /// What is left of the four rotations besides their mean and one turn's sine and cosine.
  double Alternating(int axis, int down, int channel) const;
  /// Sine and cosine of one turn.
  Eigen::Vector2d Harmonic(int axis, int down, int channel) const;
};

/// The runs of a table; a new one begins where a position comes back.
Result<std::vector<PositionRun>> ReadPositionRuns(const BenchTable& data, double tolerance);

}  // namespace wellgyro
