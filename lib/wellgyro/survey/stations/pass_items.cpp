#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "wellgyro/survey/stations/pass_items_internal.h"
#include "wellgyro/survey/stations/station_of.h"
#include "wellgyro/survey/stations/way.h"

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

/// The points of a pass between two depths, where no leg there is longer than kUnseenLeg; else
/// none.
std::vector<PathStation> SeenBetween(const PassItems& pass, double from, double to) {
  std::vector<PathStation> seen;
  double md = from;
  const auto take = [&](const PathStation& point) {
    if (!(point.md > md) || !(point.md < to)) return true;
    if (point.md - md > kUnseenLeg) return false;
    seen.push_back(point);
    md = point.md;
    return true;
  };
  for (const PassItem& item : pass) {
    if (!item.on_line) continue;
    if (!std::ranges::all_of(item.way, take) || !take(PathOf(item.station))) return {};
  }
  return to - md > kUnseenLeg ? std::vector<PathStation>{} : seen;
}

/// The way to `below` with what other passes saw where this one has no depth.
std::vector<PathStation> FilledWay(std::optional<PathStation> above, const PassItem& below,
                                   std::span<const PassItems> others) {
  std::vector<PathStation> filled;
  const auto add = [&](const PathStation& point, bool own) {
    for (std::size_t i = 0; above && i < others.size() && point.md - above->md > kUnseenLeg; ++i) {
      const std::vector<PathStation> seen = SeenBetween(others[i], above->md, point.md);
      filled.insert(filled.end(), seen.begin(), seen.end());
      if (!seen.empty()) break;
    }
    if (own) filled.push_back(point);
    above = point;
  };
  for (const PathStation& point : below.way) add(point, true);
  add(PathOf(below.station), false);
  return filled;
}

/// Where depth was missing on one way and not on another, the hole was seen.
void FillGaps(std::vector<PassItems>& passes) {
  const std::vector<PassItems> as_seen = passes;
  for (PassItems& pass : passes) {
    const PassItem* above = nullptr;
    for (PassItem& item : pass) {
      if (!item.on_line || item.state == nullptr) continue;
      item.way =
          FilledWay(above ? std::optional(PathOf(above->station)) : std::nullopt, item, as_seen);
      above = &item;
    }
  }
}

bool GoesOut(const PassItems& pass) { return pass.front().station.pass == Pass::kOut; }

/// Of some passes in a row every station as the tool met it; empty where one has no state of its
/// own, or time stands still.
PassItems InTimeOrder(std::span<const PassItems> passes) {
  PassItems items;
  for (const PassItems& pass : passes) {
    if (GoesOut(pass)) {
      items.insert(items.end(), pass.rbegin(), pass.rend());
    } else {
      items.insert(items.end(), pass.begin(), pass.end());
    }
  }
  const auto stateless = [](const PassItem& item) { return item.state == nullptr; };
  const auto not_later = [](const PassItem& a, const PassItem& b) {
    return a.state->knot >= b.state->knot;
  };
  if (std::ranges::any_of(items, stateless)) return {};
  return std::ranges::adjacent_find(items, not_later) == items.end() ? items : PassItems{};
}

/// The last of some passes behind those that led to where it begins; as it is where none did. Of
/// these the stations above count, the others only carry the correlations on: errors of one tool
/// on one way, and not independent of each other as those of two lines.
PassItems Continued(std::span<const PassItems> passes, std::span<const Waypoint> way) {
  const PassItems& own = passes.back();
  PassItems whole = InTimeOrder(passes);
  const PassItem* above = nullptr;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    PassItem& item = whole[i];
    if (i + own.size() < whole.size()) {
      item.carried = true;
      item.on_line = item.station.pass != Pass::kOut && item.station.md < SeenFrom(own) &&
                     (above == nullptr || item.station.md > above->station.md);
    }
    if (!item.on_line) continue;
    if (above != nullptr && above->station.pass_number != item.station.pass_number) {
      item.way = WayBetween(way, above->station, item.station);
    }
    above = &item;
  }
  return !whole.empty() && whole.front().on_line ? whole : own;
}

/// A tool may be drawn back on its way in: what follows is a pass that begins in the hole.
void ContinueWays(std::span<const Waypoint> way, std::vector<PassItems>& passes) {
  double top = HUGE_VAL;
  for (const PassItems& pass : passes) top = std::min(top, SeenFrom(pass));
  const std::vector<PassItems> as_met = passes;
  for (std::size_t i = 1; i < passes.size(); ++i) {
    if (GoesOut(passes[i]) || SeenFrom(passes[i]) - top <= kUnseenLeg) continue;
    passes[i] = Continued(std::span(as_met).first(i + 1), way);
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
  ContinueWays(run.way, result);
  FillGaps(result);
  return result;
}

}  // namespace wellgyro
