#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/time.h"

/// @file
/// What people, tools and programs say about a run. People are data: whatever someone does that can
/// change a result comes in here, from the wire or from the job.
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
  /// Whether there is a value of the event's kind. A depth_rezero, a depth_tie and a foresight
  /// without one are refused; a depth_zero and a return_to_zero without one mean 0 m.
  bool has_value = false;
  double value_m = 0;    ///< of depth events [m]
  double sigma_m = 0;    ///< [m]
  double value_rad = 0;  ///< of a foresight: true direction of the reference mark [rad]
  double sigma_rad = 0;  ///< [rad]
  std::string what;      ///< shoe, tag, mark, hold-up ...
  std::string who;
  std::string text;
};

/// An order with the signature of whoever gave it; see proto/operation_t.lcm.
struct SignedOperation {
  UtcTime utc;  ///< when it was signed, by the survey's samples
  std::int32_t session = 0;
  std::int32_t id = 0;
  std::vector<std::byte> key;      ///< public
  std::vector<std::byte> content;  ///< a message with its fingerprint
  std::vector<std::byte> signature;
};

/// Somebody whose orders are obeyed.
struct OperatorKey {
  std::string name;
  std::vector<std::byte> key;  ///< public, Ed25519
};

/// Who may order what of a survey while it runs, or in its log.
struct OperationSpec {
  /// None: unsigned orders are obeyed, live those from this machine only.
  std::vector<OperatorKey> keys;
  /// With keys: what the tool says of itself and its modes is obeyed unsigned all the same.
  bool unsigned_tool = false;
};

/// What became of an order, signed or not.
struct OperationRecord {
  std::string key;  ///< its name in the job; "unsigned"; or the first bytes of one that is unknown
  std::int32_t session = 0;
  std::int32_t id = 0;
  UtcTime utc;       ///< when it holds
  std::string kind;  ///< as accept
  std::string who;
  bool obeyed = false;
  std::string effect;  ///< one sentence; of one that was refused, why
};

/// Asks for what was said before.
struct StationRequest {
  UtcTime utc;
  std::int64_t seq = 0;
  std::int32_t session = 0;
  std::int32_t from_revision = 0;
};

/// Health of one program, sent once a second. Values are those of status_t.
struct Status {
  enum class State : std::int32_t { kOk = 0, kDegraded = 1, kFault = 2 };
  UtcTime utc;
  std::int64_t seq = 0;
  std::int32_t session = 0;
  State state = State::kOk;
  std::int32_t last_command_id = 0;  ///< acknowledges that command; 0 if none
  std::int64_t samples_received = 0;
  std::int64_t samples_lost = 0;  ///< by sequence number
  std::int64_t gaps = 0;
  std::int64_t duplicates = 0;
  std::int64_t malformed = 0;                ///< messages of wrong fingerprint, size or range
  std::optional<std::int64_t> kernel_drops;  ///< datagrams that the system threw away
  double latency_p99 = 0;                    ///< [s]
  double data_age = 0;                       ///< [s]
  std::string text;
};

}  // namespace wellgyro
