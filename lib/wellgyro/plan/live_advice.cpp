#include "wellgyro/plan/live_advice.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/plan/stop_information.h"

namespace wellgyro {
namespace {

using Rest = StopStand::Rest;
using Action = Advice::Action;

// Places for a stop on a way, at most: of a plan's kPlacesMost 0.4, whose matrices have a sixth of
// the numbers, since live advice is to be quick.
constexpr double kPlaces = 40;
// [m] above its deepest place the run is on its way up: more than a string is lifted off its slips.
constexpr double kGoesUp = 10;

/// This place, then those of the plan's way that are still ahead.
std::vector<StopPlace> PlacesAhead(const PlannedWay& way, double md, bool out) {
  std::vector<StopPlace> places{{out, md}};
  const double spacing = std::max(units::kStand, (way.end_md - way.begin_md) / kPlaces);
  for (const StopPlace& place : PlacesEvery(way, spacing)) {
    const bool down = !place.out && !out && place.md > md + Advice::kHere;
    const bool up = place.out && (!out || place.md < md - Advice::kHere);
    if (down || up) places.push_back(place);
  }
  return places;
}

Advice None(const PlanLimits& limits, std::string why) {
  Advice advice;
  advice.ellipse_limit = limits.ellipse;
  advice.hidden_limit = limits.hidden;
  advice.text = std::move(why);
  return advice;
}

std::string StopText(bool out, double md, double seconds, const std::optional<double>& toolface) {
  std::string text =
      fmt::format("{:.0f} s at {:.0f} m{}", seconds, md, out ? " on the way up" : "");
  if (toolface) text += fmt::format(", toolface {:.0f} deg", ToDegrees(*toolface));
  return text;
}

std::string TextOf(const Advice& a) {
  std::string text = a.action == Action::kStay   ? fmt::format("stay {:.0f} s more", a.seconds)
                     : a.action == Action::kStop ? fmt::format("stop here for {:.0f} s", a.seconds)
                                                 : std::string("move on");
  if (a.action == Action::kStop && a.toolface) {
    text += fmt::format(" at toolface {:.0f} deg", ToDegrees(*a.toolface));
  }
  if (a.next)
    text += ", next " + StopText(a.next->out, a.next->md, a.next->seconds, a.next->toolface);
  if (!a.next && a.action == Action::kMoveOn) text += ", no stop left";
  text += fmt::format("; end {:.2f} m of {:.2f} m", a.ellipse, a.ellipse_limit);
  if (a.hidden) text += fmt::format(", unseen {:.2f} m of {:.2f} m", *a.hidden, *a.hidden_limit);
  if (!a.reachable) text += "; the limits can no longer be met";
  return text;
}

/// What the run may still do, and how the search is to see it.
struct Ahead {
  PlanCase c;
  PlanLimits limits;
  bool out = false;
  double fresh = 0;  ///< of the rest here, what the information does not hold yet [s]
};

Ahead AheadOf(const PlanCase& c, const PlanLimits& limits, const AskingRun& run) {
  Ahead ahead{c, limits, *run.md < run.deepest - kGoesUp, 0};
  PlannedWay& way = ahead.c.way;
  if (ahead.out) way.end_md = std::min(way.end_md, run.deepest);
  ahead.fresh = std::max(0.0, run.rested - (run.state != nullptr ? run.rest_known : 0));
  if (run.rested > 0) {
    ahead.limits.here = PlanLimits::Here{run.rested - ahead.fresh, ahead.fresh};
  }
  if (run.state != nullptr) {
    ahead.limits.fewest = 0;
  } else {
    way.begin_md = *run.md;
    ahead.limits.fewest = c.sigma_start_azimuth ? 0 : 1;
  }
  return ahead;
}

/// Of the stops found, what to do here and what next.
void TakeStops(const StopInformation& info, const std::vector<Rest>& rests, const Ahead& ahead,
               double rested, Advice& advice) {
  for (const Rest& rest : rests) {
    const StopPlace& place = info.place(rest.place);
    const bool here = rest.place == 0;
    const double seconds = rest.seconds - (here ? ahead.fresh : 0);
    if (seconds < 0.5) continue;
    advice.rest_left += seconds;
    std::optional<double> toolface;
    if (ahead.limits.turns) toolface = WrapTwoPi(place.toolface + rest.turn);
    if (here) {
      advice.action = rested > 0 ? Action::kStay : Action::kStop;
      advice.seconds = seconds;
      if (rested == 0) advice.toolface = toolface;
      continue;
    }
    if (!advice.next) advice.next = Advice::Next{place.out, place.md, seconds, toolface};
    ++advice.stops_left;
  }
}

}  // namespace

AskingRun AskingOf(const RunNow& now, std::optional<UtcTime> newest, double deepest) {
  AskingRun run{.md = now.md, .deepest = deepest, .state = now.state};
  if (now.md) run.deepest = std::max(run.deepest, *now.md);
  if (now.state != nullptr) run.deepest = now.state->way.deepest;
  if (!(now.rested > 0)) return run;
  run.rest_known = now.rested;
  run.rested = now.rested + (newest ? std::max(0.0, (*newest - now.utc).seconds()) : 0);
  return run;
}

Advice Advise(const PlanCase& c, const PlanLimits& limits, const AskingRun& run) {
  if (!run.md) return None(limits, "no depth yet");
  const Ahead ahead = AheadOf(c, limits, run);
  const PlannedWay& way = ahead.c.way;
  if (ahead.out && run.state == nullptr) return None(limits, "no north was found on the way down");
  const double left = ahead.out ? (way.speed_out > 0 ? *run.md - way.begin_md : 0)
                                : way.end_md - *run.md + (way.speed_out > 0 ? kGoesUp : 0);
  // The last stop may be where the way ends: while it rests there, the tool is told for how long.
  if (!(left >= kGoesUp) && !(run.rested > 0)) return None(limits, "no way is left");
  const RunSoFar so_far{run.state, ahead.out};
  // What is known of a tool at rest is known of where it rests.
  const bool rests = run.state != nullptr && run.rest_known > 0;
  const double md = rests ? run.state->node().md : *run.md;
  const StopInformation info(ahead.c,
                             PlacesAhead(way, std::clamp(md, way.begin_md, way.end_md), ahead.out),
                             {.so_far = run.state != nullptr ? &so_far : nullptr,
                              .with_faults = limits.hidden.has_value(),
                              .knots = kAdviceKnots});
  if (!info.solved()) return None(limits, "the run so far cannot be gone on from");
  Advice advice = None(limits, {});
  StopStand stand(info, limits.ellipse, limits.hidden.value_or(HUGE_VAL));
  if (ahead.fresh > 0) stand.Add({0, 0, ahead.fresh});
  advice.ellipse_now = stand.Value().ellipse;
  const auto stops = FindStops(info, ahead.limits);
  advice.reachable = stops.has_value();
  advice.action = Action::kMoveOn;
  if (stops) {
    for (const Rest& rest : *stops) {
      const double seconds = rest.seconds - (rest.place == 0 ? ahead.fresh : 0);
      if (seconds > 0.5) stand.Add({rest.place, rest.turn, seconds});
    }
    TakeStops(info, *stops, ahead, run.rested, advice);
  }
  const PlanValue value = stand.Value();
  advice.ellipse = value.ellipse;
  if (limits.hidden) advice.hidden = value.hidden;
  advice.text = TextOf(advice);
  return advice;
}

}  // namespace wellgyro
