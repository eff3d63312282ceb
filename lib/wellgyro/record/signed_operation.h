#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "wellgyro/base/time.h"

namespace wellgyro {

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

}  // namespace wellgyro
