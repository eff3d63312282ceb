#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "wellgyro/base/time.h"
#include "wellgyro/record/quality.h"

/// @file
/// What the sensors of a tool say: sample by sample, or as means at rest.
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
/// mark, y right-handed. What a tool does not measure (z of `w_IT_T` without has_gz, `b_T` without
/// has_mag) is not used: leave it 0.
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

/// Means over one stretch at rest, in tool axes T: found in the samples by alignment/, or sent by a
/// tool that averages down-hole (multishot, drop, gyro while drilling).
struct StillWindow {
  ToolTime begin, end;  ///< on the tool's clock, where the window rests on samples
  UtcTime utc_begin, utc_end;
  std::int64_t seq_begin = 0;  ///< first sample, where the window rests on samples
  std::int64_t seq_end = 0;    ///< one past the last
  std::int32_t session = 0;
  std::int32_t run = 0;
  std::int32_t tool = 0;
  std::int64_t samples = 0;  ///< samples in the means; 0 where the tool averaged
  Eigen::Vector3d w_IT_T = Eigen::Vector3d::Zero();        ///< mean rate [rad/s]; z where has_gz
  Eigen::Vector3d sigma_w_IT_T = Eigen::Vector3d::Zero();  ///< of the mean, noise alone [rad/s]
  Eigen::Vector3d f_T = Eigen::Vector3d::Zero();           ///< mean specific force [m/s^2]
  Eigen::Vector3d sigma_f_T = Eigen::Vector3d::Zero();     ///< of the mean, noise alone [m/s^2]
  Eigen::Vector3d b_T = Eigen::Vector3d::Zero();           ///< flux density [T]; where has_mag
  bool has_gz = false;
  bool has_mag = false;
  /// Rate of the toolface over the window, by gravity; absent where too short to tell [rad/s].
  std::optional<double> roll_rate;
  double sigma_roll_rate = 0;                  ///< noise alone [rad/s]
  std::optional<std::int32_t> index_position;  ///< of an indexing tool
  std::optional<double> md;                    ///< measured depth [m]
  double temperature = 0;                      ///< [degC]
  Quality quality = Quality::kGood;

  double seconds() const {
    return samples > 0 ? (end - begin).seconds() : (utc_end - utc_begin).seconds();
  }
};

}  // namespace wellgyro
