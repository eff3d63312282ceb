#pragma once

#include <array>
#include <span>

#include "wellgyro/base/export.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// What the converters of a tool give for rates, forces and fields in SI units and tool axes T: the
/// formula of SensorGroup as it stands. Counts are rounded; pulses counted per second keep their
/// remainder for the next sample, as a counter does.
class WELLGYRO_EXPORT RawCounter {
 public:
  explicit RawCounter(const ToolCalibration& tool) : tool_(tool) {}

  /// Samples in their order. Every thermometer is given `temperature` [degC], true; the term in the
  /// heating rate takes `heating_rate` [degC/s].
  RawSample Count(const ImuSample& truth, double temperature, double heating_rate = 0);

 private:
  void CountGroup(const SensorGroup& group, const Eigen::Vector3d& u_T, const ImuSample& truth,
                  double temperature, double heating_rate, RawSample& raw);

  ToolCalibration tool_;
  std::array<double, RawSample::kChannelsMax> remainder_{};
};

/// What a thermometer's channel gives at the true temperature `temperature` [degC].
WELLGYRO_EXPORT double RawTemperature(const ThermometerCalibration& thermometer,
                                      double temperature);

}  // namespace wellgyro
