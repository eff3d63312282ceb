#pragma once

#include <cstddef>

#include "wellgyro/record/tool_calibration.h"

#include "fit/tool_bench.h"

namespace wellgyro::test {

inline constexpr double kG = 9.80665;

/// The tool model that the bench's tool is, in the trade's axes; counts of a millionth.
/// Channels, temperatures and axes of the bench's gyros, or its accelerometers.
inline void PlaceGroup(bool gyro, SensorGroup& group) {
  group.n_channels = gyro ? 4 : 3;
  for (int c = 0; c < group.n_channels; ++c) {
    group.channel[static_cast<std::size_t>(c)] = (gyro ? 3 : 0) + c;
  }
  group.thermometer = 0;
  group.reference = 87.5;
  group.half_range = 62.5;
  group.min = 25;
  group.max = 150;
  // Bench x is -y of the tool, bench y its x.
  group.R_TS << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  if (!gyro) group.R_TS = -group.R_TS;
  group.unit_per_count.setConstant(1e-6);
}

inline ToolCalibration ModelOf(const ThermalTool& tool) {
  ToolCalibration model;
  model.thermometers.resize(1);
  PlaceGroup(true, model.gyro);
  PlaceGroup(false, model.accel);
  for (std::size_t n = 0; n < 4; ++n) {
    model.gyro.bias[n] = tool.bg[n];
    model.accel.bias[n].head<3>() = tool.ba[n];
  }
  const double per_h = kRad / 3600;
  model.gyro.sensitivity[0] = tool.U / per_h;
  for (std::size_t n = 0; n < 2; ++n) {
    model.accel.sensitivity[n].topRows<3>() = tool.Sa[n] / kG;
    const Eigen::Vector4d mq = tool.MQ[n] / kG;
    SensorGroup::Rows& force = model.gyro.g_dependence[n];
    force(0, 0) = force(1, 1) = mq[0];
    force(0, 1) = mq[1];
    force(1, 0) = -mq[1];
    force(3, 0) = force(2, 2) = mq[2];
    force(3, 2) = mq[3];
    force(2, 0) = -mq[3];
  }
  const int place[] = {5, 4, 4, 3};
  for (int c = 0; c < 4; ++c) model.gyro.g_squared(c, place[c]) = tool.N[c] / (kG * kG);
  for (int c = 0; c < 3; ++c) model.accel.second_order(c, c) = tool.K2[c] / (kG * kG);
  model.gyro.heating = tool.heating;
  return model;
}

}  // namespace wellgyro::test
