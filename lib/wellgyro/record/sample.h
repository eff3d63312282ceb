#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "wellgyro/base/time.h"

namespace wellgyro {

/// Where a sample stands. A sample is the mean over the period that begins at its times.
struct SampleStamp {
  ToolTime tool_time;        ///< begin, on the tool's free-running clock
  UtcTime utc;               ///< begin, as the surface estimates it
  std::int64_t seq = 0;      ///< number of the sample in its session
  std::int32_t session = 0;  ///< changes whenever the source restarts
  std::int32_t run = 0;      ///< run of the job, from 1; 0 when the source does not know
  std::int32_t tool = 0;     ///< tool in the string
  std::int32_t period_ns = 0;
  bool gyro_saturated = false;
  bool accel_saturated = false;
  bool utc_unsynced = false;  ///< the surface doubts `utc`
  bool simulated = false;
  bool temperature_outside = false;  ///< beyond the calibrated temperatures
  float temperature = 0;             ///< [degC]
};

/// One sample in SI units and tool axes T: z down-hole along the axis, x to the housing's reference
/// mark, y right-handed.
struct ImuSample {
  SampleStamp stamp;
  Eigen::Vector3d w_IT_T = Eigen::Vector3d::Zero();  ///< mean angular rate [rad/s]; z where has_gz
  Eigen::Vector3d f_T = Eigen::Vector3d::Zero();     ///< mean specific force [m/s^2]
  Eigen::Vector3d b_T = Eigen::Vector3d::Zero();     ///< magnetic flux density [T]; where has_mag
  bool has_gz = false;
  bool has_mag = false;
};

/// One sample as the tool's converters give it; what a channel means stands in the tool model.
struct RawSample {
  static constexpr int kChannelsMax = 16;
  static constexpr int kTemperaturesMax = 8;

  SampleStamp stamp;  ///< stamp.temperature is not used
  std::int32_t n_channels = 0;
  std::int32_t n_temperatures = 0;
  std::array<std::int32_t, kChannelsMax> counts{};
  std::array<float, kTemperaturesMax> temperature_raw{};
};

}  // namespace wellgyro
