#pragma once

#include <string>

namespace wellgyro {

/// Names of the message channels; a job may rename them.
struct Channels {
  std::string raw = "WELLGYRO_RAW";
  std::string imu = "WELLGYRO_IMU";
  std::string still = "WELLGYRO_STILL";
  std::string depth = "WELLGYRO_DEPTH";
  std::string mode = "WELLGYRO_MODE";
  std::string tool = "WELLGYRO_TOOL";
  std::string event = "WELLGYRO_EVENT";
  std::string command = "WELLGYRO_CMD";
  std::string station = "WELLGYRO_STATION";
  std::string status = "WELLGYRO_STATUS";
};

}  // namespace wellgyro
