#include "wellgyro/live/operation_gate.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/core.h>

#include "wellgyro/bus/decode.h"
#include "wellgyro/bus/encode.h"
#include "wellgyro/io/signature.h"
#include "wellgyro/io/words.h"
#include "wellgyro/survey/intake/plausible.h"

namespace wellgyro {
namespace {

// Beyond it a repeated order counts as new. The surveyor has its own bound by then.
constexpr std::size_t kKnownMax = 2 * Surveyor::kOperationsMax;

template <class Integer>
void Append(std::vector<std::byte>& bytes, Integer value) {
  for (int shift = 8 * static_cast<int>(sizeof value) - 8; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::byte>(value >> shift & 0xff));
  }
}

void Append(std::vector<std::byte>& bytes, std::string_view text) {
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  bytes.insert(bytes.end(), begin, begin + text.size());
  bytes.push_back(std::byte{0});
}

std::string_view WordOf(Command::Kind kind) {
  switch (kind) {
    case Command::Kind::kTakeStation:
      return "take_station";
    case Command::Kind::kStartContinuous:
      return "start_continuous";
    case Command::Kind::kStopContinuous:
      return "stop_continuous";
    case Command::Kind::kAbort:
      return "abort";
    case Command::Kind::kAdjust:
      return "adjust";
    case Command::Kind::kFinish:
      return "finish";
    case Command::Kind::kNone:
      break;
  }
  return "none";
}

std::string EffectOf(const Command& command) {
  switch (command.kind) {
    case Command::Kind::kTakeStation:
      return command.md ? fmt::format("a station is taken at MD {:.2f} m", *command.md)
                        : "a station is taken";
    case Command::Kind::kAdjust:
      return "all stations are revised";
    case Command::Kind::kFinish:
      return "the survey ends";
    default:
      return "none: it is for the tool";
  }
}

std::string StationsOf(const Event& event) {
  const std::string run = event.run == 0 ? "of all runs" : fmt::format("of run {}", event.run);
  return event.has_value ? fmt::format("stations {} at MD {:.2f} m", run, event.value_m)
                         : fmt::format("all stations {}", run);
}

std::string EffectOf(const Event& event) {
  switch (event.kind) {
    case Event::Kind::kDepthZero:
    case Event::Kind::kDepthRezero:
    case Event::Kind::kDepthTie:
      return fmt::format("depths from then on read {:.2f} m there", event.value_m);
    case Event::Kind::kReturnToZero:
      return "the depth's closure is checked";
    case Event::Kind::kForesight:
      return "the azimuth is checked";
    case Event::Kind::kRunBegin:
      return fmt::format("run {} begins", event.run);
    case Event::Kind::kRunEnd:
      return event.what == "misrun" ? "the run ends, a misrun" : "the run ends";
    case Event::Kind::kAccept:
      return StationsOf(event) + " are definitive";
    case Event::Kind::kReject:
      return StationsOf(event) + " are rejected";
    case Event::Kind::kRemark:
      break;
  }
  return "none: it is a remark";
}

MessageType ContentType(const SignedOperation& operation) {
  return TypeOf(operation.content).value_or(MessageType::kStatus);
}

}  // namespace

std::vector<std::byte> SignedBytes(const SignedOperation& operation, const std::string& well) {
  std::vector<std::byte> bytes;
  Append(bytes, std::string_view("wellgyro operation 1"));
  Append(bytes, std::string_view(well));
  Append(bytes, operation.utc.ns / 1000);
  Append(bytes, operation.session);
  Append(bytes, operation.id);
  bytes.insert(bytes.end(), operation.content.begin(), operation.content.end());
  return bytes;
}

void OperationGate::Refuse(OperationRecord record, const std::string& why) {
  // An order comes three times, since any may be lost, and is named once.
  auto order = std::tuple(record.key, record.session, record.id, why);
  if (record.id != 0 && refused_last_ == order) {
    ++refused_;
    return;
  }
  refused_last_ = std::move(order);
  record.obeyed = false;
  record.effect = "refused: " + why;
  Keep(std::move(record));
}

void OperationGate::Keep(OperationRecord record, bool event) {
  ++(record.obeyed ? obeyed_ : refused_);
  if (tell_) tell_(record, event);
  // Those that were refused, of which there may be any number, leave room for the others.
  const bool room = records_.size() < (record.obeyed ? kKept : kKept / 2);
  if (room) records_.push_back(std::move(record));
}

bool OperationGate::IsNew(const std::string& key, std::int32_t session, std::int32_t id) {
  if (id == 0 || known_.size() >= kKnownMax) return true;
  return known_.emplace(key, session, id).second;
}

void OperationGate::HeardAt(UtcTime utc) {
  heard_ = utc;
  while (!waiting_.empty()) {
    const SignedOperation operation = std::move(waiting_.front());
    waiting_.pop_front();
    Judge(operation);
  }
}

void OperationGate::Take(const SignedOperation& operation) {
  // What is forged takes no place among those that wait for the time.
  if (heard_ || !WhyForged(operation).empty()) return Judge(operation);
  if (waiting_.size() < kWaitMax) return waiting_.push_back(operation);
  Refuse(RecordOf(operation, {}), "too many orders came before the first sample");
}

const OperatorKey* OperationGate::KeyOf(const SignedOperation& operation) const {
  const auto& keys = spec_.keys;
  const auto key = std::find_if(keys.begin(), keys.end(), [&operation](const OperatorKey& k) {
    return k.key == operation.key;
  });
  return key == keys.end() ? nullptr : &*key;
}

OperationRecord OperationGate::RecordOf(const SignedOperation& operation,
                                        std::string effect) const {
  const OperatorKey* key = KeyOf(operation);
  OperationRecord record;
  record.key = key == nullptr ? HexOf(operation.key).substr(0, 16) : key->name;
  record.session = operation.session;
  record.id = operation.id;
  record.utc = operation.utc;
  record.kind = TypeName(ContentType(operation));
  record.effect = std::move(effect);
  return record;
}

std::string OperationGate::WhyForged(const SignedOperation& operation) const {
  if (KeyOf(operation) == nullptr) {
    return spec_.keys.empty() ? "the job lists no keys" : "its key is not in the job";
  }
  if (!Verify(operation.key, SignedBytes(operation, well_), operation.signature)) {
    return "its signature is wrong, or for another well";
  }
  // Without a number the same order again would be another one.
  return operation.id != 0 ? "" : "it has no number";
}

std::string OperationGate::WhyNot(const SignedOperation& operation) const {
  if (std::string forged = WhyForged(operation); !forged.empty()) return forged;
  const Duration off = operation.utc - *heard_;
  if (std::max(off, Duration{-off.ns}) > kFresh) {
    return fmt::format("it was signed {:.0f} s from the samples' time", off.seconds());
  }
  const MessageType type = ContentType(operation);
  const bool possible = type == MessageType::kEvent || type == MessageType::kCommand ||
                        type == MessageType::kToolMode || type == MessageType::kToolInfo;
  if (!possible) return "it holds no event, command, mode or description of a tool";
  const Result<Message> content = Decode(type, operation.content);
  return content ? "" : content.fault().text;
}

void OperationGate::Judge(const SignedOperation& operation) {
  OperationRecord record = RecordOf(operation, {});
  if (const std::string why = WhyNot(operation); !why.empty()) {
    return Refuse(std::move(record), why);
  }
  if (IsNew(HexOf(operation.key), record.session, record.id)) {
    ObeyContent(std::move(record), operation);
  }
}

void OperationGate::ObeyContent(OperationRecord record, const SignedOperation& operation) {
  Message content = *Decode(ContentType(operation), operation.content);
  // The order's own number, under which it is known to be one, goes for its content too.
  if (auto* command = std::get_if<Command>(&content)) {
    command->session = operation.session;
    command->command_id = operation.id;
    Obey(std::move(record), *command);
  } else if (auto* event = std::get_if<Event>(&content)) {
    event->session = operation.session;
    event->event_id = operation.id;
    Obey(std::move(record), *event);
  } else {
    const auto* info = std::get_if<ToolInfo>(&content);
    if (info != nullptr) {
      const std::string why = WhyImplausible(*info);
      if (!why.empty()) return Refuse(std::move(record), why);
      surveyor_.Push(*info);
    }
    if (const auto* mode = std::get_if<ToolMode>(&content)) surveyor_.Push(*mode);
    record.obeyed = true;
    record.effect = "used";
    Keep(std::move(record));
  }
}

void OperationGate::Obey(OperationRecord record, const Command& command) {
  record.utc = command.utc;
  record.kind = WordOf(command.kind);
  if (const std::string why = WhyImplausible(command); !why.empty()) {
    return Refuse(std::move(record), why);
  }
  record.obeyed = true;
  record.effect = EffectOf(command);
  finish_ = finish_ || command.kind == Command::Kind::kFinish;
  Keep(std::move(record));
  surveyor_.Push(command);
}

void OperationGate::Obey(OperationRecord record, const Event& event) {
  record.utc = event.utc;
  record.kind = wellgyro::WordOf(event.kind);
  record.who = event.who;
  if (const std::string why = WhyImplausible(event); !why.empty()) {
    return Refuse(std::move(record), why);
  }
  record.obeyed = true;
  record.effect = EffectOf(event);
  Keep(std::move(record), true);
  surveyor_.Push(event);
}

void OperationGate::Take(const Command& command) {
  OperationRecord record{.key = "unsigned", .session = command.session, .id = command.command_id};
  if (spec_.keys.empty()) {
    if (IsNew("command", record.session, record.id)) Obey(std::move(record), command);
    return;
  }
  record.utc = command.utc;
  record.kind = WordOf(command.kind);
  Refuse(std::move(record), "the job lists keys, and it is not signed");
}

void OperationGate::Take(const Event& event) {
  OperationRecord record{.key = "unsigned", .session = event.session, .id = event.event_id};
  if (spec_.keys.empty()) {
    if (IsNew("event", record.session, record.id)) Obey(std::move(record), event);
    return;
  }
  record.utc = event.utc;
  record.kind = wellgyro::WordOf(event.kind);
  record.who = event.who;
  Refuse(std::move(record), "the job lists keys, and it is not signed");
}

/// What the tool says of itself comes often and is named once.
bool OperationGate::TakeOfTool(const char* kind, UtcTime utc, std::int32_t session) {
  if (spec_.keys.empty() || spec_.unsigned_tool) return true;
  if (!told_of_tool_.insert(kind).second) {
    ++refused_;
    return false;
  }
  OperationRecord record{.key = "unsigned", .session = session, .utc = utc, .kind = kind};
  Refuse(std::move(record),
         "the job lists keys, and it is not signed; [operations] unsigned_tool = true uses it");
  return false;
}

bool OperationGate::Take(const ToolMode& mode) {
  return TakeOfTool("tool_mode", mode.utc, mode.session);
}
bool OperationGate::Take(const ToolInfo& info) {
  return TakeOfTool("tool_info", info.utc, info.session);
}

}  // namespace wellgyro
