#include "wellgyro/survey/run/knot_cutter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/survey/intake/sample_counts.h"

namespace wellgyro {
namespace {

// From knot to knot on the way. A knot costs .35 kB and its share of the adjustment; in 1 s 15 rpm
// are 90 deg, up to which a hidden roll is made up for (kHiddenTurnMost), in 2 s 7.5 rpm would be.
constexpr std::int64_t kKnotNs = 1'000'000'000;
constexpr double kLeastFraction = 1e-9;  // of a sample, at which it can be cut: 1 ns of a second
// [m] in one sample, or in each second of a gap: no hole is logged so fast, the depth is wrong.
constexpr double kJump = 50;
// Periods from a sample to its successor, at most: amid 1, the next, and 2, where one is missing.
constexpr double kWithoutGap = 1.5;

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

/// Where a sample ends that none follows: no further than where it begins, and not nearer than it
/// goes in its period.
AlongHole AtItsEnd(const AlongHole& begin, std::int64_t period_ns) {
  AlongHole end = begin;
  end.sigma_md = std::hypot(begin.sigma_md, begin.speed * 1e-9 * static_cast<double>(period_ns));
  return end;
}

}  // namespace

KnotCutter::KnotCutter(const Job& job, WaitingKnots& waiting, RunSummary& summary)
    : job_(job), waiting_(waiting), summary_(summary), marks_(job), feed_(job) {}

void KnotCutter::Heed(const SampleStamp& stamp) {
  if (stamp.temperature_outside) quality_ |= Quality::kTemperature;
  end_unsynced_ = stamp.utc_unsynced;
}

void KnotCutter::CountAliased(std::int64_t samples) {
  summary_.samples_aliased += samples;
  if (samples > 0) quality_ |= Quality::kAliased;
}

bool KnotCutter::Follows(const ImuSample& sample) const {
  return CanFollow(last_taken_ ? &*last_taken_ : nullptr, sample);
}

std::optional<KnotCutter::End> KnotCutter::EndBefore(const ImuSample& next, UtcTime utc,
                                                     const AlongHole& along,
                                                     const PassState& pass) {
  if (!current_) return std::nullopt;
  Current& c = *current_;
  const double reach =
      static_cast<double>((next.stamp.tool_time - c.begin).ns) / static_cast<double>(c.period_ns);
  if (next.stamp.session != c.session) {
    return End{AtItsEnd(c.along, c.period_ns), c.pass, 1};
  }
  if (reach >= kWithoutGap) return End{along, pass, reach};
  CountAliased(TurnsFar(c.sample.f_T.head<2>(), next.f_T.head<2>()));
  c.utc_end = utc;
  return End{along, pass, 1};
}

std::optional<KnotCutter::End> KnotCutter::LastEnd(const PassState& pass) {
  if (!current_) return std::nullopt;
  const AlongHole end = AtItsEnd(current_->along, current_->period_ns);
  const bool down = end.known && pass.pass == Pass::kIn;
  if (down && !marks_.asked() && !marks_.IsMarked(end.md)) marks_.Ask(std::nullopt);
  return End{end, pass, 1};
}

void KnotCutter::Sum() {
  feed_.Push(current_->sample, current_->rests);
  Give();
}

void KnotCutter::Give() {
  const auto utc_of = [this](ToolTime time) {
    return current_ ? current_->utc + (time - current_->begin) : summary_.end;
  };
  feed_.Give(utc_of, waiting_);
}

Draft KnotCutter::NewDraft(double md) const {
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

bool KnotCutter::Place(const End& end) {
  cuts_.clear();
  const Current& c = *current_;
  AlongHole mixed;
  if (end.reach != 1) mixed = Between(c.along, end.along, 1 / end.reach);
  const AlongHole& here = end.reach != 1 ? mixed : end.along;  // where the sample ends
  const bool known = c.along.known && end.along.known;
  bool list_last = false;
  if (known && end.pass.number == c.pass.number && c.pass.pass != Pass::kStationary &&
      (end.pass.md != c.pass.md || c.pass.begins)) {
    list_last = PlaceTargets(end.pass.md, end.reach);
  }
  PlaceByTime();
  if (const auto md = marks_.TakeAsked(known ? std::optional(here.md) : std::nullopt)) {
    cuts_.push_back({1.0, NewDraft(*md), false});
  }
  if (known && marks_.ComesToRest(here, c.begin + Duration{c.period_ns})) {
    cuts_.push_back({1.0, NewDraft(here.md), false});
    cuts_.back().draft->listed = false;
  }
  return list_last;
}

/// At whole seconds of the tool clock, and at the job's instant.
void KnotCutter::PlaceByTime() {
  const Current& c = *current_;
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
}

/// At the planned depths that the tool passes within the sample, and the gap after it, up to
/// `md_next`. True: one of them is where the station of a stop is already.
bool KnotCutter::PlaceTargets(double md_next, double reach) {
  const PassState& pass = current_->pass;
  const double way = md_next - pass.md;
  const double seconds = reach * 1e-9 * static_cast<double>(current_->period_ns);
  if (std::abs(way) > kJump * std::max(seconds, 1.0)) return false;
  // A first pass begins where the tool stood; between any other turn and its discovery the depths
  // belong to the pass before.
  const bool first = pass.begins && std::abs(pass.md_turn - pass.md) <= 2 * kSameDepth;
  bool list_last = false;
  for (const StationPlan::Target& target :
       marks_.Between(first ? pass.md_turn : pass.md, md_next, first)) {
    if (first && marks_.IsMarked(target.md)) {
      list_last |= target.listed;
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
  return list_last;
}

bool KnotCutter::Cut(const End& end) {
  std::stable_sort(cuts_.begin(), cuts_.end(),
                   [](const KnotAt& a, const KnotAt& b) { return a.fraction < b.fraction; });
  for (const KnotAt& cut : cuts_) CutAt(cut, end);
  return !cuts_.empty();
}

void KnotCutter::CutAt(const KnotAt& cut, const End& end) {
  const ToolTime time =
      current_->begin + Duration{std::llround(cut.fraction * current_->period_ns)};
  const bool again = last_knot_ && time.ns <= last_knot_->ns + kSameNs;
  if (again && (waiting_.empty() || waiting_.back().draft)) return;
  if (!again) MakeKnot(time, cut.fraction, end);
  // Two cuts of one place are one knot.
  WaitingKnot& last = waiting_.back();
  last.external = last.external || cut.external;
  if (cut.draft) {
    last.along.md = cut.draft->station.md;
    marks_.Mark(cut.draft->station.md);
    last.draft = cut.draft;
    last.draft->station.utc = last.utc;
    last.draft->station.tool_time = last.end;
  }
}

void KnotCutter::MakeKnot(ToolTime time, double fraction, const End& end) {
  const Current& c = *current_;
  feed_.Cut(fraction, c.period_ns);
  WaitingKnot knot;
  knot.begin = last_knot_.value_or(c.begin);
  knot.end = time;
  knot.utc = c.utc + Duration::Seconds(fraction * (c.utc_end - c.utc).seconds());
  knot.along = Between(c.along, end.along, fraction / end.reach);
  knot.quality = std::exchange(quality_, Quality::kGood);
  knot.temperature = c.sample.stamp.temperature;
  waiting_.push_back(std::move(knot));
  last_knot_ = time;
}

void KnotCutter::Begin(const ImuSample& sample, UtcTime utc, const AlongHole& along,
                       const AlongHole& middle, const PassState& pass) {
  if (!current_) current_.emplace();
  Current& c = *current_;  // member by member: built whole it would be copied twice
  c.begin = sample.stamp.tool_time;
  c.period_ns = sample.stamp.period_ns;
  c.session = sample.stamp.session;
  c.rests = middle.known && std::abs(middle.speed) < kRestSpeed;
  c.sample = sample;
  c.utc = utc;
  c.utc_end = utc + Duration{sample.stamp.period_ns};
  c.along = along;
  c.pass = pass;
  last_taken_ = sample.stamp;
  summary_.end = c.utc_end;
}

void KnotCutter::Flush() {
  current_.reset();
  feed_.Flush();
  Give();
}

std::size_t KnotCutter::Room(const LocatedBlock& block, std::size_t at) const {
  const SampleStamp& first = block.samples.samples[at].stamp;
  if (!current_ || marks_.asked()) return 0;
  const Current& c = *current_;
  const bool next = c.begin + Duration{c.period_ns} == first.tool_time;
  if (!c.along.known || c.pass.begins || !next) return 0;
  // The samples that are summed are those from the current to the last but one.
  const std::int64_t second = (c.begin.ns / kKnotNs + 1) * kKnotNs;
  const std::int64_t before = (second - c.begin.ns - 1) / c.period_ns;
  return std::min(static_cast<std::size_t>(before), feed_.Room(c.sample.stamp));
}

bool KnotCutter::IsPlain(UtcTime utc, double furthest) {
  const Current& c = *current_;
  const std::optional<UtcTime>& at_utc = job_.alignment.at_utc;
  if (at_utc && *at_utc >= c.utc && *at_utc < utc) return false;
  const bool still = c.pass.pass == Pass::kStationary || furthest == c.pass.md;
  return still || marks_.Between(c.pass.md, furthest, false).empty();
}

void KnotCutter::Append(const LocatedBlock& block, std::size_t at, std::size_t count,
                        const PassState& pass) {
  const SampleBlock samples = block.samples.Part(at, count);
  const std::size_t last = at + count - 1;
  Current& c = *current_;
  CountAliased(FarTurns(c.sample.f_T.head<2>(), samples.axes));
  const auto rests = [&block](std::size_t begin, std::size_t n) {
    const auto speed =
        block.middle.speed.segment(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(n));
    return speed.abs().maxCoeff() < kRestSpeed;
  };
  if (count > 1) feed_.Append(samples.Part(0, count - 1), rests(at, count - 1));
  c.begin = samples.last().tool_time;
  c.rests = rests(last, 1);
  c.sample = samples.samples.back();
  c.utc = block.utc[last];
  c.utc_end = c.utc + Duration{c.period_ns};
  c.along = block.begin.At(last);
  c.pass = pass;
  last_taken_ = samples.last();
  summary_.end = c.utc_end;
}

}  // namespace wellgyro
