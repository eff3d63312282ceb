#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "wellgyro/base/time.h"

/// What people and tools say about a run. People are data: whatever someone does that can change a
/// result comes in here, from the wire or from the job.
namespace wellgyro {

/// What the tool is doing.
struct ToolMode {
  enum class Mode : std::int32_t {
    kUnknown = 0,
    kIdle = 1,
    kMoving = 2,
    kStationary = 3,
    kGyrocompass = 4,
    kContinuous = 5,
  };
  UtcTime utc;
  std::int64_t seq = 0;
  std::int32_t session = 0;
  std::int32_t run = 0;
  Mode mode = Mode::kUnknown;
  std::optional<std::int64_t> imu_seq;  ///< first sample for which it holds; wins over utc
  std::int32_t command_id = 0;          ///< command that caused it; 0 if none
  std::optional<std::int32_t> index_position;
  double index_angle = 0;  ///< [rad]; where index_position
};

/// What a tool of the string is.
struct ToolInfo {
  UtcTime utc;
  std::int64_t seq = 0;
  std::int32_t session = 0;
  std::int32_t run = 0;
  std::int32_t tool = 0;
  std::int32_t string_position = 0;   ///< from the bottom, 1
  double sensor_below_reference = 0;  ///< sensor point below the depth reference, along hole [m]
  std::string asset_serial;
  std::string sensor_serials;  ///< separated by ;
  std::string firmware;
  std::string calibration_sha256;
};

/// A request to the surveyor; obeyed once per command_id.
struct Command {
  enum class Kind : std::int32_t {
    kNone = 0,
    kTakeStation = 1,
    kStartContinuous = 2,
    kStopContinuous = 3,
    kAbort = 4,
    kAdjust = 5,
    kFinish = 6,
  };
  UtcTime utc;
  std::int64_t seq = 0;
  std::int32_t session = 0;
  std::int32_t command_id = 0;
  Kind kind = Kind::kNone;
  std::optional<double> duration;  ///< [s]
  std::optional<double> md;        ///< depth to assign [m]
};

/// Something a person did or saw that can change the result.
struct Event {
  enum class Kind : std::int32_t {
    kDepthZero = 1,
    kDepthRezero = 2,
    kDepthTie = 3,
    kReturnToZero = 4,
    kForesight = 5,
    kRunBegin = 6,
    kRunEnd = 7,
    kAccept = 8,
    kReject = 9,
    kRemark = 10,
  };
  UtcTime utc;  ///< when it holds
  std::int64_t seq = 0;
  std::int32_t session = 0;
  std::int32_t run = 0;  ///< 0: the run at that time
  Kind kind = Kind::kRemark;
  std::int32_t event_id = 0;  ///< the same event sent again has the same id; 0: none
  bool has_value = false;
  double value_m = 0;    ///< of depth events [m]
  double sigma_m = 0;    ///< [m]
  double value_rad = 0;  ///< of a foresight: true direction of the reference mark [rad]
  double sigma_rad = 0;  ///< [rad]
  std::string what;      ///< shoe, tag, mark, hold-up ...
  std::string who;
  std::string text;
};

}  // namespace wellgyro
