#include "wellgyro/survey/operations_due.h"

#include <algorithm>
#include <iterator>

#include <fmt/core.h>

#include "wellgyro/survey/tool_survey_internal.h"

namespace wellgyro {
namespace {

// Modes, and commands and events, that wait for their time; more come from a broken sender alone.
constexpr std::size_t kDueMax = 1000;

UtcTime TimeOf(const Operation& operation) {
  return std::visit([](const auto& record) { return record.utc; }, operation);
}

bool IsMode(const Operation& operation) { return std::holds_alternative<ToolMode>(operation); }

}  // namespace

/// False: there is none for `due` itself.
bool OperationsDue::MakeRoom(const Due& due) {
  const bool mode = IsMode(due.operation);
  if ((mode ? modes_ : due_.size() - modes_) < kDueMax) return true;
  sink_.OnFault(Fault{FaultCode::kRange,
                      fmt::format("more than {} {} wait for samples of tool {}: one is left out",
                                  kDueMax, mode ? "modes" : "commands and events", tool_)});
  if (!mode) return false;
  const auto last =
      std::find_if(due_.rbegin(), due_.rend(), [](const Due& d) { return IsMode(d.operation); });
  if (last->utc <= due.utc) return false;
  due_.erase(std::next(last).base());
  --modes_;
  return true;
}

void OperationsDue::Push(const Operation& operation) {
  const Due due{TimeOf(operation), operation};
  if (!MakeRoom(due)) return;
  const auto after = std::upper_bound(due_.begin(), due_.end(), due.utc,
                                      [](UtcTime utc, const Due& d) { return utc < d.utc; });
  due_.insert(after, due);
  modes_ += IsMode(operation) ? 1 : 0;
}

bool OperationsDue::IsDue(const Due& due, const SampleStamp& stamp, UtcTime utc) {
  if (const auto* mode = std::get_if<ToolMode>(&due.operation)) {
    const bool waits = utc - due.utc < kHeld;  // longer no sample is on its way
    if (waits && mode->imu_seq && mode->session == stamp.session) {
      return *mode->imu_seq <= stamp.seq;
    }
  }
  return due.utc <= utc;
}

bool OperationsDue::Any(const SampleStamp& stamp, UtcTime utc) const {
  return !due_.empty() && (due_.front().utc <= utc || IsDue(due_.front(), stamp, utc));
}

std::optional<Operation> OperationsDue::Next(const SampleStamp& stamp, UtcTime utc) {
  for (auto due = due_.begin(); due != due_.end(); ++due) {
    if (IsDue(*due, stamp, utc)) {
      const Operation operation = due->operation;
      due_.erase(due);
      modes_ -= IsMode(operation) ? 1 : 0;
      return operation;
    }
    // A mode may wait for its sample longer than its time says; nothing else does.
    if (due->utc > utc) break;
  }
  return std::nullopt;
}

std::vector<Operation> OperationsDue::TakeUncommanded() {
  const auto commands = std::stable_partition(due_.begin(), due_.end(), [](const Due& due) {
    return !std::holds_alternative<Command>(due.operation);
  });
  std::vector<Operation> taken;
  for (auto due = due_.begin(); due != commands; ++due) taken.push_back(due->operation);
  due_.erase(due_.begin(), commands);
  modes_ = 0;
  return taken;
}

std::vector<Operation> OperationsDue::TakeCommands() {
  modes_ = 0;
  std::vector<Operation> taken;
  for (const Due& due : std::exchange(due_, {})) taken.push_back(due.operation);
  return taken;
}

bool OperationsDue::IsNew(const Event& event) {
  return event.event_id == 0 || events_.insert({event.session, event.event_id}).second;
}

bool OperationsDue::IsNew(const Command& command) {
  return command.command_id == 0 || commands_.insert({command.session, command.command_id}).second;
}

}  // namespace wellgyro
