#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "wellgyro/base/time.h"
#include "wellgyro/base/units.h"

namespace wellgyro {

/// What a run that goes on had best do for the limits of its plan: whoever runs the tool decides,
/// and no survey is changed by it.
struct Advice {
  static constexpr double kHere = units::kStand / 3;  ///< a place within it is this one [m]

  enum class Action : std::int32_t {
    kNone,    ///< nothing can be advised; `text` says why
    kStop,    ///< stop here, for `seconds`
    kStay,    ///< at rest: for `seconds` more
    kMoveOn,  ///< no stop here, or no longer
  };
  /// The next stop after this place.
  struct Next {
    bool out = false;                     ///< on the way up
    double md = 0;                        ///< of the sensor point [m]
    double seconds = 0;                   ///< [s]
    std::optional<double> toolface = {};  ///< to be turned to before [rad]
  };

  UtcTime utc;  ///< of the newest sample
  std::int64_t seq = 0;
  std::int32_t session = 0;
  std::int32_t run = 0;
  Action action = Action::kNone;
  double seconds = 0;              ///< [s]
  std::optional<double> toolface;  ///< where kStop wants the tool turned to one [rad]
  std::optional<Next> next;
  std::int32_t stops_left = 0;  ///< after this place
  double rest_left = 0;         ///< in all, here too [s]
  bool reachable = false;       ///< the limits can still be met
  double ellipse = 0;           ///< semi-major axis of the end's, advice followed [m]
  double ellipse_now = 0;       ///< without another stop [m]
  double ellipse_limit = 0;     ///< [m]
  std::optional<double> hidden, hidden_limit;  ///< by a fault that stays unseen [m]
  std::string text;                            ///< in a sentence
};

}  // namespace wellgyro
