#include "wellgyro/survey/run/stop_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/alignment/gyrocompass.h"
#include "wellgyro/calibration/field_checks.h"
#include "wellgyro/estimate/hidden_roll.h"
#include "wellgyro/estimate/setup.h"

namespace wellgyro {
namespace {

// Between windows of one stop where there is no depth: to turn a tool takes less, to move it by a
// stand and hang it again more.
constexpr double kSamePlaceSeconds = 120;
// The still detector knows of a block of 1 s when the one after it has ended, in the third.
constexpr Duration kMakeUpMind = Duration::Seconds(3);

StillSetup StillSetupOf(const Job& job) {
  StillSetup setup;
  setup.gyro = job.noise;
  setup.errors = job.errors;
  setup.min_still = Duration::Seconds(job.alignment.min_still);
  return setup;
}

}  // namespace

StopWatch::StopWatch(const Job& job, const PathSite& site, WaitingKnots& waiting,
                     RunSummary& summary)
    : job_(job), site_(site), waiting_(waiting), summary_(summary), still_(StillSetupOf(job)) {}

void StopWatch::Push(const ImuSample& sample, const AlongHole& begin, const AlongHole& middle) {
  if (const auto window = still_.Push(sample, middle)) Take(*window);
  if (!held()) return;
  const std::optional<double> md = begin.known ? std::optional(begin.md) : std::nullopt;
  if (!IsAt(stops_.back(), sample.stamp.tool_time, md)) Leave();
}

void StopWatch::Cut(std::optional<std::int32_t> index_position) {
  if (const auto window = still_.Cut(index_position)) Take(*window);
}

void StopWatch::Flush() {
  if (const auto window = still_.Flush()) Take(*window);
  DecideStill(true);
  if (held()) Leave();
}

bool StopWatch::IsAt(const Stop& stop, ToolTime time, std::optional<double> md) {
  const StillWindow& last = stop.windows.back();
  return last.md && md ? std::abs(*md - *last.md) <= kOneStop
                       : (time - last.end).seconds() <= kSamePlaceSeconds;
}

void StopWatch::Take(const StillWindow& window) {
  // What feels no force at all is not at rest on the Earth: its accelerometers are dead.
  if (window.f_T.isZero(0)) return;
  if (held() && !IsAt(stops_.back(), window.begin, window.md)) Leave();
  if (!held()) stops_.emplace_back();
  stops_.back().windows.push_back(window);
}

/// Ends the windows of the stop: decides which of the waiting knots are still, and gyrocompasses.
void StopWatch::Leave() {
  Stop& stop = stops_.back();
  for (WaitingKnot& knot : waiting_) {
    if (knot.end <= stop.windows.back().end) knot.still = IsStill(knot);
  }
  CheckAtRest(stop.windows);
  stop.fix = FixOf(stop.windows);
  stop.windows.clear();
  stop.phase = Stop::Phase::kLeft;
}

/// Checks of a third gyro axis: vertical and horizontal rate. Gravity and the rate's size are
/// checked with the fix.
void StopWatch::CheckAtRest(std::span<const StillWindow> windows) {
  FieldCheckSetup setup;
  setup.reference.gravity = site_.site().gravity;
  setup.reference.latitude = site_.site().latitude;
  setup.gyro = job_.noise;
  setup.errors = job_.errors;
  for (const StillWindow& window : windows) {
    if (!window.has_gz) continue;
    for (Check& check : CheckWindow(window, setup)) {
      if (check.code != "earth_rate_vertical" && check.code != "earth_rate_horizontal") continue;
      check.run = summary_.run;
      summary_.stop_checks.push_back(std::move(check));
    }
  }
}

NorthFix StopWatch::FixOf(std::span<const StillWindow> windows) const {
  GyrocompassSetup setup;
  setup.gyro = job_.noise;
  setup.errors = job_.errors;
  const double depth = job_.well.datum_elevation - site_.site().height;
  setup.sigma_gravity_ref =
      std::hypot(setup.sigma_gravity_ref, EstimateSetup().sigma_gravity_gradient * depth);
  NorthFix fix = Gyrocompass(windows, site_.site(), setup);
  fix.md = windows.back().md;
  fix.run = summary_.run;
  fix.tool = summary_.tool;
  return fix;
}

/// A stop that is held, or what may still become one, covers all of this knot.
bool StopWatch::IsStill(const WaitingKnot& knot) const {
  const auto covers = [&knot](const StillWindow& window) {
    return window.begin <= knot.begin && knot.end <= window.end;
  };
  const std::optional<StillWindow> open = still_.OpenWindow();
  if (open && covers(*open)) return true;
  return held() && std::any_of(stops_.back().windows.begin(), stops_.back().windows.end(), covers);
}

void StopWatch::DecideStill(bool all) {
  for (WaitingKnot& knot : waiting_) {
    if (knot.still) continue;
    const bool decided = all || waiting_.back().end - knot.end >= kMakeUpMind;
    if (const bool still = IsStill(knot); still || decided) knot.still = still;
  }
}

std::optional<NorthFix> StopWatch::Due(std::optional<ToolTime> until) {
  if (stops_.empty() || stops_.front().phase != Stop::Phase::kLeft) return std::nullopt;
  const NorthFix fix = stops_.front().fix;
  if (until && fix.end > *until) return std::nullopt;
  stops_.pop_front();
  return fix;
}

void StopWatch::Pass(const RunKnot& knot) {
  roll_hidden_ |= RollIsHidden(knot);
  rested_ = knot.still ? rested_ + knot.increment.seconds : 0;
}

bool StopWatch::TakeRollHidden() { return std::exchange(roll_hidden_, false); }

}  // namespace wellgyro
