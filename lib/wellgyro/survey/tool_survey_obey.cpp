// What people and tools ask of a survey, obeyed when its samples get there.
#include <cmath>

#include "wellgyro/survey/intake/station_marks.h"
#include "wellgyro/survey/tool_survey.h"
#include "wellgyro/survey/tool_survey_internal.h"

namespace wellgyro {

/// The track's depth; after its last mark, that of a string which stood when it came.
AlongHole ToolSurvey::DepthHeldAt(UtcTime utc) const {
  const AlongHole along = string_.track.At(utc);
  if (along.known || string_.track.empty()) return along;
  const UtcTime last = string_.track.newest();
  if (utc < last || utc - last > kHeld) return along;
  const AlongHole end = string_.track.At(last);
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
  if (!operations_.IsNew(event)) return;
  const bool reads = event.kind == Event::Kind::kReturnToZero;
  crew_.Take(event, string_.book.RunAt(event.utc, event.run),
             reads ? DepthHeldAt(event.utc) : AlongHole{});
}

void ToolSurvey::Obey(const Command& command) {
  if (!operations_.IsNew(command)) return;
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
