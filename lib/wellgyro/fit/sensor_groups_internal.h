#pragma once

#include <Eigen/Core>

#include "wellgyro/calibration/bench_axes.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// Three channels with v = bias + sensitivity u + K q(u), u in `si` SI units, in the bench's axes;
/// `sign` -1 where u is gravity in place of specific force.
inline SensorGroup ThreeChannels(const Eigen::Vector3d& bias, const Eigen::Matrix3d& sensitivity,
                                 double si, BenchAxes axes, bool gravity_signed, const char* unit) {
  SensorGroup group;
  group.n_channels = 3;
  group.channel = {0, 1, 2};
  group.unit = unit;
  group.bias[0].head<3>() = bias;
  group.sensitivity[0].topRows<3>() = sensitivity / si;
  group.R_TS = (gravity_signed ? -1 : 1) * ToolFromBench(axes);
  return group;
}

}  // namespace wellgyro
