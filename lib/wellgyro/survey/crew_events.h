#pragma once

#include <cstdint>
#include <vector>

#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/record/station.h"
#include "wellgyro/survey/verdict/checks.h"

namespace wellgyro {

/// What people have said of one tool's survey: what they accept and reject, foresights, and depths
/// read back at zero.
class CrewEvents {
 public:
  /// `run`: the one at the event's time; `read`: the depth there, where the event is a return to
  /// zero. Other kinds are not for this.
  void Take(const Event& event, std::int32_t run, const AlongHole& read);

  /// By the last that accepted or rejected it; `adjusted`: it has been.
  StationStatus StatusOf(const Station& station, bool adjusted) const;
  /// Each with its run.
  const std::vector<Event>& foresights() const { return foresights_; }
  const std::vector<ReturnToZero>& returns() const { return returns_; }

 private:
  std::vector<Event> verdicts_;  ///< accepts and rejects, in the order in which they came
  std::vector<Event> foresights_;
  std::vector<ReturnToZero> returns_;
};

}  // namespace wellgyro
