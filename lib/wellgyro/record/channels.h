#pragma once

#include <string>

/// @file
/// Names of the message channels.
namespace wellgyro {

/// Names of the message channels. The defaults are those of proto/; a job may rename them, to run
/// two surveys on one network for instance. LCM takes at most 63 bytes.
struct Channels {
  std::string raw = "WELLGYRO_RAW";          ///< raw_batch_t
  std::string imu = "WELLGYRO_IMU";          ///< imu_batch_t
  std::string still = "WELLGYRO_STILL";      ///< still_window_t
  std::string depth = "WELLGYRO_DEPTH";      ///< depth_t
  std::string mode = "WELLGYRO_MODE";        ///< tool_mode_t
  std::string tool = "WELLGYRO_TOOL";        ///< tool_info_t
  std::string event = "WELLGYRO_EVENT";      ///< event_t
  std::string command = "WELLGYRO_CMD";      ///< survey_cmd_t
  std::string station = "WELLGYRO_STATION";  ///< survey_station_t
  std::string status = "WELLGYRO_STATUS";    ///< status_t

  friend bool operator==(const Channels&, const Channels&) = default;
};

}  // namespace wellgyro
