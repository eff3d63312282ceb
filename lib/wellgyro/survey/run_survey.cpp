#include "wellgyro/survey/run_survey.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/survey/choose.h"
#include "wellgyro/survey/run_survey_internal.h"

namespace wellgyro {
namespace {

constexpr double kLeastFraction = 1e-9;  // of a sample, at which it can be cut
// [m] in one sample, or in each second of a gap: no hole is logged so fast, the depth is wrong.
constexpr double kJump = 50;
constexpr double kWithoutGap = 1.5;  // periods from a sample to its successor, at most

StillSetup StillSetupOf(const Job& job) {
  StillSetup setup;
  setup.gyro = job.noise;
  setup.errors = job.errors;
  setup.min_still = Duration::Seconds(job.alignment.min_still);
  return setup;
}

IncrementOptions IncrementOptionsOf(const Job& job) {
  IncrementOptions options;
  options.order = job.attitude.order == AttitudeSpec::Order::kSecond ? IncrementOptions::kSecond
                                                                     : IncrementOptions::kThird;
  options.accel_noise = job.errors.accel_noise;
  options.angle_random_walk = job.noise.angle_random_walk;
  if (job.errors.accel_bias_sigma > 0) options.accel_bias = job.errors.accel_bias_sigma;
  return options;
}

AlongHole Between(const AlongHole& a, const AlongHole& b, double fraction) {
  if (!a.known || !b.known) return {};
  const auto mix = [fraction](double x, double y) { return x + fraction * (y - x); };
  return {mix(a.md, b.md),
          mix(a.speed, b.speed),
          mix(a.acceleration, b.acceleration),
          mix(a.sigma_md, b.sigma_md),
          true,
          mix(a.sigma_speed, b.sigma_speed),
          mix(a.sigma_acceleration, b.sigma_acceleration)};
}

}  // namespace

RunSurvey::RunSurvey(const Job& job, std::int32_t run, std::int32_t tool)
    : job_(job),
      site_(job),
      outside_(job),
      plan_(job),
      builder_(IncrementOptionsOf(job)),
      still_(StillSetupOf(job)) {
  summary_.run = run;
  summary_.tool = tool;
}

void RunSurvey::Push(const ImuSample& sample, UtcTime utc, const AlongHole& along,
                     const AlongHole& middle) {
  if (summary_.samples == 0) summary_.begin = utc;
  Count(sample.stamp, 1);
  CountDepth(sample.stamp, along.known);
  const PassState& pass = along.known ? passes_.Push(utc, along.md) : passes_.state();
  if (sample.stamp.temperature_outside) temperature_outside_ = true;
  end_unsynced_ = sample.stamp.utc_unsynced;
  const bool taken = CanFollow(last_taken_ ? &*last_taken_ : nullptr, sample);
  if (taken && current_) {
    const double reach = static_cast<double>((sample.stamp.tool_time - current_->begin).ns) /
                         static_cast<double>(current_->period_ns);
    if (sample.stamp.session != current_->session) {
      TakeCurrent(current_->along, current_->pass, 1);
    } else if (reach < kWithoutGap) {
      CountTurn(sample);
      current_->utc_end = utc;
      TakeCurrent(along, pass, 1);
    } else {
      TakeCurrent(along, pass, reach);
    }
  }
  if (taken) {
    const UtcTime utc_end = utc + Duration{sample.stamp.period_ns};
    if (!current_) current_.emplace();
    Current& c = *current_;  // member by member: built whole it would be copied twice
    c.begin = sample.stamp.tool_time;
    c.period_ns = sample.stamp.period_ns;
    c.session = sample.stamp.session;
    c.rests = middle.known && std::abs(middle.speed) < kRestSpeed;
    c.sample = sample;
    c.utc = utc;
    c.utc_end = utc_end;
    c.along = along;
    c.pass = pass;
    last_taken_ = sample.stamp;
    summary_.end = utc_end;
  }
  if (const auto window = still_.Push(sample, middle)) TakeWindow(*window);
  if (!group_.empty()) {
    const std::optional<double> md = along.known ? std::optional(along.md) : std::nullopt;
    if (!SamePlace(sample.stamp.tool_time, md)) CloseGroup();
  }
}

/// A tool that rolls by more than a right angle from one sample to the next, by gravity.
void RunSurvey::CountTurn(const ImuSample& sample) {
  summary_.samples_aliased += TurnsFar(current_->sample.f_T.head<2>(), sample.f_T.head<2>());
}

void RunSurvey::Count(const SampleStamp& stamp, std::int64_t samples) {
  RunSummary& s = summary_;
  s.temperature_min =
      s.samples == 0 ? stamp.temperature : std::min(s.temperature_min, stamp.temperature);
  s.temperature_max =
      s.samples == 0 ? stamp.temperature : std::max(s.temperature_max, stamp.temperature);
  s.samples += samples;
  s.samples_gyro_saturated += samples * stamp.gyro_saturated;
  s.samples_accel_saturated += samples * stamp.accel_saturated;
  s.samples_unsynced += samples * stamp.utc_unsynced;
  s.samples_temperature_outside += samples * stamp.temperature_outside;
}

void RunSurvey::CountDepth(const SampleStamp& stamp, bool known) {
  if (known) {
    if (depth_seen_) summary_.seconds_without_depth += seconds_unknown_;
    seconds_unknown_ = 0;
    depth_seen_ = true;
  } else {
    seconds_unknown_ += 1e-9 * stamp.period_ns;
  }
}

void RunSurvey::Cut(std::optional<std::int32_t> index_position) {
  if (const auto window = still_.Cut(index_position)) TakeWindow(*window);
}

void RunSurvey::TakeStation(std::optional<double> md) {
  asked_ = true;
  asked_md_ = md;
}

void RunSurvey::Flush() {
  if (current_) {
    // A run that ends on its way down ends in a station.
    const AlongHole& end = current_->along;
    asked_ = asked_ || (end.known && passes_.state().pass == Pass::kIn &&
                        std::abs(end.md - last_mark_md_) > kSameDepth);
    TakeCurrent(end, passes_.state(), 1);
    current_.reset();
  }
  if (const auto window = still_.Flush()) TakeWindow(*window);
  DecideStill(true);
  CloseGroup();
  builder_.Flush();
  TakeIncrements();
  StepReady(true);
  UseClosedStops(std::nullopt);
}

/// In a gap, once the sample behind it has come.
void RunSurvey::CutIncrement(double fraction) {
  if (fraction <= 1) {
    builder_.Cut(fraction);
  } else {
    gap_cuts_.push_back(Duration{std::llround((fraction - 1) * current_->period_ns)});
  }
}

/// To the knots that wait for them. One that the builder ended by itself was asked for by nobody.
void RunSurvey::TakeIncrements() {
  auto next = std::find_if(waiting_.begin(), waiting_.end(),
                           [](const Waiting& w) { return !w.increment.has_value(); });
  while (builder_.Ready()) {
    Increment increment = builder_.Pop();
    const bool asked = next != waiting_.end() && next->end.ns <= increment.time.ns + kSameNs;
    if (!asked) {
      Waiting own;
      own.end = increment.time;
      own.begin = own.end - Duration::Seconds(increment.seconds);
      own.utc = current_ ? current_->utc + (own.end - current_->begin) : summary_.end;
      next = waiting_.insert(next, own);
    }
    next->increment = std::move(increment);
    ++next;
  }
}

Draft RunSurvey::NewDraft(double md) const {
  Draft draft;
  Station& s = draft.station;
  s.run = summary_.run;
  s.tool = summary_.tool;
  s.pass = current_->pass.pass;
  s.pass_number = current_->pass.number;
  s.md = md;
  // Where UTC steps, depths are passed between a sample that is sure of it and one that is not.
  if (end_unsynced_) s.quality |= Quality::kClock;
  return draft;
}

/// Gives the current sample to the builder and makes the knots that fall into it.
void RunSurvey::TakeCurrent(const AlongHole& next, const PassState& pass_next, double reach) {
  cuts_.clear();
  const Current& c = *current_;
  AlongHole mixed;
  if (reach != 1) mixed = Between(c.along, next, 1 / reach);
  const AlongHole& end = reach != 1 ? mixed : next;
  const bool known = c.along.known && next.known;
  builder_.Push(c.sample, c.rests);
  for (const Duration into : gap_cuts_) builder_.CutGap(into);
  gap_cuts_.clear();
  TakeIncrements();
  StepReady(false);
  if (known && pass_next.number == c.pass.number && c.pass.pass != Pass::kStationary &&
      (pass_next.md != c.pass.md || c.pass.begins)) {
    AddTargets(pass_next.md, reach);
  }
  const double period = static_cast<double>(c.period_ns);
  const std::int64_t begin = c.begin.ns;
  const std::int64_t second = (begin / kKnotNs + 1) * kKnotNs;
  if (second <= begin + c.period_ns) {
    cuts_.push_back({static_cast<double>(second - begin) / period, std::nullopt, false});
  }
  const std::optional<UtcTime>& at_utc = job_.alignment.at_utc;
  if (at_utc && *at_utc >= c.utc && *at_utc < c.utc_end) {
    const double fraction = (*at_utc - c.utc).seconds() / (period * 1e-9);
    cuts_.push_back({std::clamp(fraction, kLeastFraction, 1.0), std::nullopt, true});
  }
  if (asked_ && (asked_md_ || known)) {
    cuts_.push_back({1.0, NewDraft(asked_md_.value_or(end.md)), false});
  }
  asked_ = false;
  if (known && ComesToRest(end)) {
    cuts_.push_back({1.0, NewDraft(end.md), false});
    cuts_.back().draft->listed = false;
  }
  if (cuts_.empty()) return;
  std::stable_sort(cuts_.begin(), cuts_.end(),
                   [](const KnotAt& a, const KnotAt& b) { return a.fraction < b.fraction; });
  for (const KnotAt& cut : cuts_) CutAt(cut, next, reach);
  DecideStill(false);
  TellAhead();
}

/// The asked depths that the tool passes within the sample, and the gap after it, up to `md_next`.
void RunSurvey::AddTargets(double md_next, double reach) {
  const PassState& pass = current_->pass;
  const double way = md_next - pass.md;
  const double seconds = reach * 1e-9 * static_cast<double>(current_->period_ns);
  if (std::abs(way) > kJump * std::max(seconds, 1.0)) return;
  // A first pass begins where the tool stood; between any other turn and its discovery the depths
  // belong to the pass before.
  const bool first = pass.begins && std::abs(pass.md_turn - pass.md) <= 2 * kSameDepth;
  plan_.Between(first ? pass.md_turn : pass.md, md_next, first, targets_);
  for (const StationPlan::Target& target : targets_) {
    if (first && marked_ && std::abs(target.md - last_mark_md_) <= kSameDepth) {
      // The station of the stop is there already.
      if (target.listed) ListLastMark();
      continue;
    }
    const double part = way != 0 ? (target.md - pass.md) / way : 1.0;
    const double fraction = std::clamp(part * reach, kLeastFraction, reach);
    Draft draft = NewDraft(target.md);
    draft.listed = target.listed;
    const bool external =
        job_.alignment.at_md && std::abs(target.md - *job_.alignment.at_md) <= kSameDepth;
    cuts_.push_back({fraction, draft, external});
  }
}

void RunSurvey::ListLastMark() {
  for (auto waiting = waiting_.rbegin(); waiting != waiting_.rend(); ++waiting) {
    if (!waiting->draft) continue;
    if (waiting->told) break;
    waiting->draft->listed = true;
    return;
  }
  if (!drafts().empty()) book_.List(drafts().size() - 1);
}

/// That makes a station, listed only if the job asks for stops or if it turns out to be the
/// deepest.
inline bool RunSurvey::ComesToRest(const AlongHole& end) const {
  if (std::abs(end.speed) > std::max(kRestSpeed, 2 * end.sigma_speed)) return false;
  return !marked_ || std::abs(end.md - last_mark_md_) > kSameDepth;
}

void RunSurvey::CutAt(const KnotAt& cut, const AlongHole& next, double reach) {
  const auto& [fraction, draft, external] = cut;
  const Current& c = *current_;
  const ToolTime begin = last_knot_.value_or(c.begin);
  const ToolTime end = c.begin + Duration{std::llround(fraction * c.period_ns)};
  const bool again = last_knot_ && end.ns <= last_knot_->ns + kSameNs;
  if (again && (waiting_.empty() || waiting_.back().draft)) return;
  if (!again) {
    CutIncrement(fraction);
    last_knot_ = end;
    Waiting knot;
    knot.begin = begin;
    knot.end = end;
    knot.utc = c.utc + Duration::Seconds(fraction * (c.utc_end - c.utc).seconds());
    knot.along = Between(c.along, next, fraction / reach);
    knot.temperature_outside = std::exchange(temperature_outside_, false);
    knot.temperature = c.sample.stamp.temperature;
    waiting_.push_back(std::move(knot));
  }
  // Two cuts of one place are one knot.
  Waiting& last = waiting_.back();
  last.external = last.external || external;
  if (draft) {
    last.along.md = draft->station.md;
    last_mark_md_ = draft->station.md;
    marked_ = true;
    last.draft = draft;
    last.draft->station.utc = last.utc;
    last.draft->station.tool_time = last.end;
  }
}

void RunSurvey::ListLastDepth() {
  Draft* deepest = nullptr;
  for (Draft& draft : drafts()) {
    if (draft.station.pass == Pass::kOut) continue;
    if (!deepest || draft.station.md > deepest->station.md) deepest = &draft;
  }
  if (deepest && job_.stations.every > 0) deepest->listed = true;
}

RunHistory RunSurvey::History() const {
  RunHistory history = history_;
  history.knots.reserve(knots_.size());
  history.attitude.reserve(knots_.size());
  KeptKnots::Reader reader(knots_);
  while (const KeptKnot* kept = reader.Next()) {
    history.knots.push_back(kept->knot);
    history.attitude.push_back(kept->attitude);
  }
  return history;
}

RunNow RunSurvey::Now() const {
  RunNow now;
  now.run = summary_.run;
  if (knots_.empty()) return now;
  const RunKnot& last = recent_.back();
  now.utc = last.utc;
  if (last.along.known) now.md = last.along.md;
  now.rested = rested_;
  if (forward_) now.state = &forward_->state();
  return now;
}

}  // namespace wellgyro
