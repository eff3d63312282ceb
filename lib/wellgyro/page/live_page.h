#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/result/survey_json.h"

namespace wellgyro {

/// What a live page shows that does not change while the survey runs.
struct LivePageHead {
  std::string well;
  std::vector<std::pair<std::string, std::string>> identity = {};  ///< as Job::identity
  std::optional<OtherWell> plan = {};                              ///< the path as planned
  bool orders = false;  ///< whether it has a form for orders, which POST /order takes
};

/// The page of a running survey: one HTML page in the report's look, with its charts' library and
/// its script within. It asks for nothing but server-sent events from /events of where it came from
/// (LiveFeed) and, where asked, sends orders to /order; its own policy forbids anything else. It
/// says by itself, within four seconds, that these events stopped, and asks again each second.
/// Faults as ParseWellStations of the plan.
WELLGYRO_EXPORT Result<std::string> LivePage(const LivePageHead& head);

}  // namespace wellgyro
