#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <utility>

#include "wellgyro/survey/pass_items_internal.h"
#include "wellgyro/survey/station_of.h"
#include "wellgyro/survey/way.h"

namespace wellgyro {
namespace {

/// The pass in the order of depth. Stations are met in the order of time, down or up; one at which
/// the tool, or its depth counter, was on its way back lies on no leg and is only carried along.
PassItems InDepthOrder(PassItems items) {
  const Pass pass = items.back().station.pass;
  if (items.front().state == nullptr) {
    std::stable_sort(items.begin(), items.end(), [](const PassItem& a, const PassItem& b) {
      return a.station.md < b.station.md;
    });
  } else if (pass == Pass::kOut) {
    std::reverse(items.begin(), items.end());
  }
  double last = -HUGE_VAL;
  for (PassItem& item : items) {
    item.on_line = item.station.md > last;
    if (item.on_line) last = item.station.md;
  }
  return items;
}

/// A stop from which the tool goes out of the hole is the deepest station of that pass, and no
/// other way leads there.
void JoinStopsBelow(std::map<std::int32_t, PassItems>& passes) {
  for (auto stop = passes.begin(); stop != passes.end();) {
    const auto next = std::next(stop);
    if (next == passes.end()) return;
    PassItems& out = next->second;
    const bool below = stop->second.back().station.pass == Pass::kStationary &&
                       stop->second.back().state != nullptr &&
                       out.front().station.pass == Pass::kOut && out.front().state != nullptr;
    if (below) {
      out.insert(out.begin(), stop->second.begin(), stop->second.end());
      passes.erase(stop);
    }
    stop = next;
  }
}

}  // namespace

std::vector<PassItems> SplitPasses(const Job& job, const DraftedRun& run) {
  std::map<std::int32_t, PassItems> passes;
  for (const Draft& draft : run.drafts) {
    const StationState* state = draft.state ? &run.states[*draft.state] : nullptr;
    passes[draft.station.pass_number].push_back(
        {StationOf(job, draft, state), state, draft.in_survey(), true});
  }
  JoinStopsBelow(passes);
  std::vector<PassItems> result;
  for (auto& [number, items] : passes) {
    result.push_back(InDepthOrder(std::move(items)));
    const PassItem* above = nullptr;
    for (PassItem& item : result.back()) {
      if (!item.on_line) continue;
      if (above == nullptr && item.state != nullptr) {
        item.way = WayAbove(run.way, item.station, item.station.pass == Pass::kOut);
      } else if (above != nullptr && above->state != nullptr && item.state != nullptr) {
        item.way = WayBetween(run.way, above->station, item.station);
      }
      above = &item;
    }
  }
  return result;
}

}  // namespace wellgyro
