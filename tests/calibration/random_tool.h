#pragma once

#include <cstdint>

#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro::test {

/// What a tool model of a test has beyond three linear channels a group.
struct ToolShape {
  int gyro_channels = 3;
  bool temperature = false;
  bool second_order = false;
  bool g_terms = false;
  bool rotated = false;
};

inline SensorGroup RandomGroup(Random& random, int channels, int first, double sensitivity,
                               double full, const ToolShape& shape) {
  SensorGroup group;
  group.n_channels = channels;
  group.unit = "V";
  for (int c = 0; c < channels; ++c) {
    group.channel[static_cast<std::size_t>(c)] = first + channels - 1 - c;
    group.unit_per_count[c] = 1e-8 * (1 + 0.1 * c);
    group.bias[0][c] = 0.02 * random.Normal();
    for (int i = 0; i < 3; ++i)
      group.sensitivity[0](c, i) =
          sensitivity * ((c % 3 == i ? 1.0 : 0.0) + 0.02 * random.Normal());
    if (c == 3) group.sensitivity[0].row(3) = -group.sensitivity[0].row(0);
    if (shape.second_order)
      for (int k = 0; k < 6; ++k)
        group.second_order(c, k) = 1e-3 * sensitivity / full * random.Normal();
  }
  if (shape.temperature) {
    group.thermometer = 0;
    group.reference = 90;
    group.half_range = 70;
    group.min = 20;
    group.max = 160;
    for (std::size_t n = 1; n < SensorGroup::kPowers; ++n) {
      for (int c = 0; c < channels; ++c) {
        group.bias[n][c] = 0.005 * random.Normal();
        for (int i = 0; i < 3; ++i)
          group.sensitivity[n](c, i) = 0.003 * sensitivity * random.Normal();
      }
    }
  }
  if (shape.rotated) group.R_TS = RotationZ(0.3) * RotationX(-1.1) * -Eigen::Matrix3d::Identity();
  return group;
}

inline ToolCalibration RandomTool(std::uint64_t seed, const ToolShape& shape) {
  Random random(seed);
  ToolCalibration tool;
  const double rate = 100 * units::kDeg;
  tool.gyro = RandomGroup(random, shape.gyro_channels, 0, 3 / rate, rate, shape);
  if (shape.gyro_channels == 2) {
    // Two axes cannot tell what they see of the third: it must be nothing to come back.
    for (auto& power : tool.gyro.sensitivity) power.col(2).setZero();
    tool.gyro.second_order.setZero();
    tool.gyro.R_TS.setIdentity();
  }
  tool.accel = RandomGroup(random, 3, 4, 0.3, 10, shape);
  tool.mag = RandomGroup(random, 3, 7, 3 / 6e-5, 6e-5, shape);
  if (shape.g_terms) {
    for (int c = 0; c < shape.gyro_channels; ++c) {
      for (int i = 0; i < 3; ++i) tool.gyro.g_dependence[0](c, i) = 1e-3 * random.Normal();
      for (int k = 0; k < 6; ++k) tool.gyro.g_squared(c, k) = 1e-5 * random.Normal();
    }
  }
  tool.thermometers.push_back({.channel = 1,
                               .offset = -50,
                               .gain = 100,
                               .c0 = -0.8,
                               .c1 = 0.012,
                               .c2 = -0.004,
                               .knee = 120,
                               .min = 0,
                               .max = 200});
  return tool;
}

inline ImuSample RandomSample(Random& random, bool has_gz) {
  ImuSample sample;
  sample.stamp.period_ns = 10'000'000;
  for (int i = 0; i < 3; ++i) {
    sample.w_IT_T[i] = units::kDeg * 50 * (2 * random.Uniform() - 1);
    sample.f_T[i] = 10 * (2 * random.Uniform() - 1);
    sample.b_T[i] = 5e-5 * (2 * random.Uniform() - 1);
  }
  if (!has_gz) sample.w_IT_T.z() = 0;
  return sample;
}

}  // namespace wellgyro::test
