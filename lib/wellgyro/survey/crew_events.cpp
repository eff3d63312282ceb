#include "wellgyro/survey/crew_events.h"

#include <cmath>

#include "wellgyro/survey/stations/choose.h"

namespace wellgyro {

void CrewEvents::Take(const Event& event, std::int32_t run, const AlongHole& read) {
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
      ReturnToZero back{run, {}, event.has_value ? event.value_m : 0, event.sigma_m};
      if (read.known) back.read_md = read.md;
      returns_.push_back(back);
      break;
    }
    default:
      break;  // depth events work in the depth track, run events in the run book
  }
}

StationStatus CrewEvents::StatusOf(const Station& station, bool adjusted) const {
  StationStatus status = adjusted ? StationStatus::kField : StationStatus::kProvisional;
  for (const Event& event : verdicts_) {
    if (event.run != 0 && event.run != station.run) continue;
    if (event.has_value && std::abs(event.value_m - station.md) > kTypedDepth) continue;
    status =
        event.kind == Event::Kind::kAccept ? StationStatus::kDefinitive : StationStatus::kRejected;
  }
  return status;
}

}  // namespace wellgyro
