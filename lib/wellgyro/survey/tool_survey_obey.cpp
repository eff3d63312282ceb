// What people and tools ask of a survey, obeyed when its samples get there.
#include <cmath>

#include "wellgyro/survey/run_survey_internal.h"
#include "wellgyro/survey/tool_survey.h"
#include "wellgyro/survey/tool_survey_internal.h"

namespace wellgyro {

bool ToolSurvey::IsDue(const Due& due, const SampleStamp& stamp, UtcTime utc) const {
  if (const auto* mode = std::get_if<ToolMode>(&due.operation)) {
    const bool waits = utc - due.utc < kHeld;  // longer no sample is on its way
    if (waits && mode->imu_seq && mode->session == stamp.session) {
      return *mode->imu_seq <= stamp.seq;
    }
  }
  return due.utc <= utc;
}

/// What holds from before this sample on; false: the survey ends with it.
bool ToolSurvey::ObeyDue(const SampleStamp& stamp, UtcTime utc) {
  for (std::size_t i = 0; i < due_.size();) {
    if (!IsDue(due_[i], stamp, utc)) {
      // A mode may wait for its sample longer than its time says; nothing else does.
      if (due_[i].utc > utc) break;
      ++i;
      continue;
    }
    const Operation operation = due_[i].operation;
    due_.erase(due_.begin() + static_cast<std::ptrdiff_t>(i));
    Obey(operation);
    if (finish_asked_) return false;
  }
  return true;
}

/// The track's depth; after its last mark, that of a string which stood when it came.
AlongHole ToolSurvey::DepthHeldAt(UtcTime utc) const {
  const AlongHole along = track_.At(utc);
  if (along.known || track_.empty()) return along;
  const UtcTime last = track_.newest();
  if (utc < last || utc - last > kHeld) return along;
  const AlongHole end = track_.At(last);
  return std::abs(end.speed) <= kRestSpeed ? end : along;
}

void ToolSurvey::Obey(const Operation& operation) {
  std::visit([this](const auto& record) { Obey(record); }, operation);
}

void ToolSurvey::Obey(const ToolMode& mode) {
  const bool changes =
      !mode_ || mode_->mode != mode.mode || mode_->index_position != mode.index_position;
  mode_ = mode;
  if (changes && !runs_.empty()) runs_.back().survey->Cut(mode.index_position);
}

void ToolSurvey::Obey(const Event& event) {
  if (event.event_id != 0 && !events_.insert({event.session, event.event_id}).second) return;
  const std::int32_t run = book_.RunAt(event.utc, event.run);
  switch (event.kind) {
    case Event::Kind::kAccept:
    case Event::Kind::kReject:
      verdicts_.push_back(event);
      break;
    case Event::Kind::kForesight:
      foresights_.push_back(event);
      foresights_.back().run = run;
      break;
    case Event::Kind::kReturnToZero: {
      const AlongHole along = DepthHeldAt(event.utc);
      ReturnToZero back{run, {}, event.has_value ? event.value_m : 0, event.sigma_m};
      if (along.known) back.read_md = along.md;
      returns_.push_back(back);
      break;
    }
    default:
      break;  // depth events work in the depth track, run events in the run book
  }
}

void ToolSurvey::Obey(const Command& command) {
  const auto key = std::pair(command.session, command.command_id);
  if (command.command_id != 0 && !commands_.insert(key).second) return;
  switch (command.kind) {
    case Command::Kind::kTakeStation:
      if (!runs_.empty()) runs_.back().survey->TakeStation(command.md);
      break;
    case Command::Kind::kAdjust:
      Adjust();
      break;
    case Command::Kind::kFinish:
      finish_asked_ = command.utc;
      break;
    default:
      break;  // the others are for the tool
  }
  sink_.OnAcknowledged(command.command_id);
}

}  // namespace wellgyro
