#pragma once

#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// One number of a tool model, by its name in ToolCalibration::covariance:
/// "gyro.bias.p1[2]" (power 1 of the temperature, channel 2), "accel.sensitivity.p0[1,2]" (channel,
/// axis), "gyro.g_dependence.p0[0,1]", "accel.second_order[0,3]", "gyro.g_squared[1,4]",
/// "gyro.heating[0]". Units as in SensorGroup: that of the channel, per SI unit.
struct CalibrationMember {
  bool is_gyro = false;
  enum class Kind { kBias, kSensitivity, kForce, kSecondOrder, kForceSquare, kHeating } kind{};
  int power = 0, channel = 0, column = 0;
};

WELLGYRO_EXPORT std::string NameOf(const CalibrationMember& member);
/// Throws std::invalid_argument for a name that is none.
WELLGYRO_EXPORT CalibrationMember MemberOf(const std::string& name);
/// The number itself.
WELLGYRO_EXPORT double& ValueOf(ToolCalibration& tool, const CalibrationMember& member);
WELLGYRO_EXPORT double ValueOf(const ToolCalibration& tool, const CalibrationMember& member);

}  // namespace wellgyro
