#include "wellgyro/depth/depth_track.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tuple>

#include "wellgyro/base/time_range.h"
#include "wellgyro/record/limits.h"

namespace wellgyro {
namespace {

// [s] between marks in which a stop may hide: from 1 m/s to rest and back at 0.4 m/s^2.
constexpr double kStopAndGo = 5;
// [m/s^2], rms, of a winch that stops and goes so once in 15 min: 0.4 sqrt(5 / 900) = 0.03.
constexpr double kUnseen = 0.03;
// [m], off its neighbours: at 10 Hz it moves the fitted depth by 2.5 cm at most and the speed by
// 0.05 m/s, at 2 Hz by 15 cm and 0.4 m/s.
constexpr double kSpikeAtLeast = 0.3;
// [m/s^2], 0.1 g, that a string is started or stopped at: of marks at 10 Hz it makes 2 cm beside
// kSpikeAtLeast, at 2 Hz 0.5 m.
constexpr double kHardest = 1;
// [m], beside what speed_limit allows: that limit's way in the 0.1 s by which stamps may be off.
constexpr double kJumpAtLeast = 1;

double Seconds(UtcTime a, UtcTime b) { return (a - b).seconds(); }

std::string Place(UtcTime utc) { return " at utime_us " + std::to_string(utc.ns / 1000); }

// No hole is as long as 100 km; numbers beyond are damage, and would ask for as many stations.
bool IsDepth(double md) { return std::abs(md) <= limits::kMd; }

}  // namespace

DepthTrack::DepthTrack(const DepthTrackSetup& setup) : setup_(setup) {
  const auto require = [](bool good, const char* what) {
    if (!good) throw std::invalid_argument(std::string("DepthTrack: ") + what);
  };
  require(setup.half_window.ns > 0, "half_window must be positive");
  require(setup.ahead.ns > 0 && setup.ahead <= setup.half_window,
          "ahead must be positive and no more than half_window");
  require(setup.latency.ns >= 0, "latency must not be negative");
  require(setup.max_gap.ns > 0, "max_gap must be positive");
  require(setup.speed_limit > 0, "speed_limit must be positive");
  require(setup.sigma_reading >= 0, "sigma_reading must not be negative");
  require(setup.sigma_md >= 0, "sigma_md must not be negative");
}

/// Index of the first mark later than `utc`.
std::size_t DepthTrack::After(UtcTime utc) const {
  const auto it = std::upper_bound(marks_.begin(), marks_.end(), utc,
                                   [](UtcTime t, const Mark& m) { return t < m.utc; });
  return static_cast<std::size_t>(it - marks_.begin());
}

bool DepthTrack::Seen(const DepthMark& mark) const {
  if (forgotten_ && mark.utc < *forgotten_ && mark.session == session_ && mark.seq <= seq_) {
    return true;
  }
  for (std::size_t i = After(mark.utc); i > 0 && marks_[i - 1].utc == mark.utc; --i) {
    if (marks_[i - 1].session == mark.session && marks_[i - 1].seq == mark.seq) return true;
  }
  return false;
}

std::optional<Fault> DepthTrack::Push(const DepthMark& mark) {
  const double sigma = mark.sigma.value_or(setup_.sigma_md);
  if (!IsWithinReach(mark.utc) || !IsWithinReach(mark.seq) || !IsDepth(mark.md) || !(sigma >= 0) ||
      !IsDepth(sigma)) {
    return Fault{.code = FaultCode::kRange,
                 .text = "depth mark that is no depth" + Place(mark.utc)};
  }
  if (Seen(mark)) return std::nullopt;
  if (!marks_.empty() && mark.utc <= newest_ - setup_.latency) {
    return Fault{.code = FaultCode::kLate,
                 .text = "depth mark" + Place(mark.utc) +
                         " came later than the depth latency allows and was left out"};
  }
  const Mark entry{.utc = mark.utc,
                   .seq = mark.seq,
                   .session = mark.session,
                   .stopped = mark.stopped,
                   .jumps = false,
                   .doubted = false,
                   .md = mark.md,
                   .sigma = sigma};
  const auto key = [](const Mark& m) { return std::tuple(m.utc, m.session, m.seq); };
  const auto it = std::ranges::upper_bound(marks_, key(entry), {}, key);
  const auto i = static_cast<std::size_t>(it - marks_.begin());
  marks_.insert(it, entry);
  for (std::size_t k = i; k < std::min(i + 3, marks_.size()); ++k) Note(k);
  if (marks_.size() == 1 || newest_ <= mark.utc) {
    newest_ = mark.utc;
    seq_ = mark.session == session_ ? std::max(seq_, mark.seq) : mark.seq;
    session_ = mark.session;
  }
  std::optional<Fault> spike = DropSpikes(i);
  for (Shift& shift : shifts_) {
    if (!shift.offset && OffsetIsKnown(shift, newest_ - setup_.latency)) {
      shift.offset = Offset(shift);
    }
  }
  return spike;
}

/// Among the mark `around` and those beside it, the earliest: behind a spike the next is doubted.
std::optional<Fault> DepthTrack::DropSpikes(std::size_t around) {
  for (std::size_t middle = std::max<std::size_t>(around, 1) - 1; middle < around + 2; ++middle) {
    if (auto fault = DropSpike(middle)) return fault;
  }
  return std::nullopt;
}

/// A doubted mark against those on both its sides: one reading far off two that agree.
std::optional<Fault> DepthTrack::DropSpike(std::size_t middle) {
  if (middle == 0 || middle + 1 >= marks_.size() || !marks_[middle].doubted) return std::nullopt;
  const Mark &a = marks_[middle - 1], &b = marks_[middle], &c = marks_[middle + 1];
  const double all = Seconds(c.utc, a.utc), part = Seconds(b.utc, a.utc);
  if (!(all > 0) || b.stopped != a.stopped) return std::nullopt;
  const double way = std::abs(c.md - a.md);
  if (way > kSpikeAtLeast + setup_.speed_limit * all) return std::nullopt;
  const double off = b.md - (a.md + (c.md - a.md) * part / all);
  if (!(std::abs(off) > kSpikeAtLeast + 0.5 * kHardest * all * all + 0.5 * way)) {
    return std::nullopt;
  }
  Fault fault{.code = FaultCode::kRange,
              .text = "depth mark" + Place(b.utc) + " reads " + std::to_string(off) +
                      " m off its neighbours and was left out"};
  marks_.erase(marks_.begin() + static_cast<std::ptrdiff_t>(middle));
  for (std::size_t k = middle; k < std::min(middle + 2, marks_.size()); ++k) Note(k);
  return fault;
}

/// How mark `i` goes on from those before it.
void DepthTrack::Note(std::size_t i) {
  if (i == 0) return;
  const Mark& before = marks_[i - 1];
  Mark& mark = marks_[i];
  const double way = mark.md - before.md, dt = Seconds(mark.utc, before.utc);
  mark.jumps = std::abs(way) > kJumpAtLeast + setup_.speed_limit * dt;
  double speed = 0, change = 0;
  if (i > 1 && !before.jumps && marks_[i - 2].utc < before.utc) {
    const double last = Seconds(before.utc, marks_[i - 2].utc);
    speed = (before.md - marks_[i - 2].md) / last;
    change = 0.5 * kHardest * dt * (dt + last);
  }
  mark.doubted = std::abs(way - speed * dt) > kSpikeAtLeast + change;
}

std::optional<Fault> DepthTrack::Push(const Event& event) {
  const bool zero = event.kind == Event::Kind::kDepthZero;
  if (!zero && event.kind != Event::Kind::kDepthRezero && event.kind != Event::Kind::kDepthTie) {
    return std::nullopt;
  }
  const auto same = [&](const Shift& s) {
    return event.event_id != 0 ? s.event_id == event.event_id && s.session == event.session
                               : s.event_id == 0 && s.utc == event.utc && s.seq == event.seq;
  };
  if (std::ranges::any_of(shifts_, same)) return std::nullopt;
  if ((!event.has_value && !zero) || !IsWithinReach(event.utc) || !IsDepth(event.value_m)) {
    return Fault{.code = FaultCode::kRange,
                 .text = "depth event without a depth" + Place(event.utc)};
  }
  if (forgotten_ && event.utc < *forgotten_) {
    return Fault{.code = FaultCode::kLate,
                 .text = "depth event" + Place(event.utc) +
                         " came after the depths at its time had been used"};
  }
  const Shift entry{.utc = event.utc,
                    .seq = event.seq,
                    .value = event.has_value ? event.value_m : 0,
                    .sigma = std::abs(event.sigma_m),
                    .session = event.session,
                    .event_id = event.event_id,
                    .offset = std::nullopt};
  const auto key = [](const Shift& s) { return std::tuple(s.utc, s.seq, s.event_id); };
  const auto it = shifts_.insert(std::ranges::upper_bound(shifts_, key(entry), {}, key), entry);
  if (!marks_.empty() && OffsetIsKnown(*it, newest_ - setup_.latency)) it->offset = Offset(*it);
  return std::nullopt;
}

std::optional<MarkRead> DepthTrack::FirstMark(UtcTime utc) const {
  const auto it = std::ranges::lower_bound(marks_, utc, {}, &Mark::utc);
  if (it == marks_.end()) return std::nullopt;
  return MarkRead{it->utc, it->md};
}

std::optional<double> DepthTrack::Deepest(UtcTime until) const {
  if (marks_.empty() || !shifts_.empty()) return std::nullopt;
  double deepest = deepest_forgotten_;
  for (const Mark& mark : marks_) {
    const bool before = needed_ && mark.utc < *needed_;
    if (!before && !mark.doubted && mark.utc <= until) deepest = std::max(deepest, mark.md);
  }
  return std::isfinite(deepest) ? std::optional(deepest) : std::nullopt;
}

/// Of the marks up to `last`, the youngest counts whatever comes after `until`.
bool DepthTrack::Stands(UtcTime last, UtcTime until) const {
  const std::size_t after = After(last);
  if (after == 0 || !marks_[after - 1].doubted) return true;
  const bool followed = after < marks_.size() && marks_[after].utc <= until;
  return followed || until - marks_[after - 1].utc >= setup_.max_gap;
}

bool DepthTrack::OffsetIsKnown(const Shift& shift, UtcTime until) const {
  const auto next = std::ranges::lower_bound(marks_, shift.utc, {}, &Mark::utc);
  if (next == marks_.end() || next->utc > until) return until - shift.utc >= setup_.max_gap;
  const UtcTime last = std::max(next->utc, shift.utc + setup_.half_window);
  return last <= until && Stands(last, until);
}

bool DepthTrack::Knows(UtcTime utc, UtcTime until) const {
  if (!IsWithinReach(utc)) return true;
  if (until < utc + setup_.ahead) return false;
  const auto next = std::ranges::upper_bound(shifts_, utc, {}, &Shift::utc);
  if (next != shifts_.begin()) {
    const Shift& shift = *std::prev(next);
    if (!shift.offset && !OffsetIsKnown(shift, until)) return false;
  }
  const std::size_t after = After(utc);
  if (after == 0) return true;
  if (after == marks_.size() || marks_[after].utc > until) return until - utc >= setup_.max_gap;
  UtcTime last = utc + AheadAt(utc);
  if (Sparse(GapAt(utc))) {
    last = marks_[after - 1].utc + setup_.max_gap;
    if (after + 1 < marks_.size()) last = std::min(last, marks_[after + 1].utc);
  }
  return last <= until && Stands(last, until);
}

std::int32_t DepthTrack::SegmentAt(UtcTime utc) const {
  const auto it = std::ranges::upper_bound(shifts_, utc, {}, &Shift::utc);
  return static_cast<std::int32_t>(it - shifts_.begin());
}

/// The marks of the segment and of the counter's unbroken way about `utc`, from the last one at or
/// before the window to the last one `ahead`, or the next after `utc`.
DepthTrack::Span DepthTrack::SpanAt(UtcTime utc, Duration ahead) const {
  const auto first = [&](UtcTime t) {
    return static_cast<std::size_t>(std::ranges::lower_bound(marks_, t, {}, &Mark::utc) -
                                    marks_.begin());
  };
  const auto next = std::ranges::upper_bound(shifts_, utc, {}, &Shift::utc);
  const std::size_t begin = next == shifts_.begin() ? 0 : first(std::prev(next)->utc);
  const std::size_t end = next == shifts_.end() ? marks_.size() : first(next->utc);
  const std::size_t middle = std::clamp(After(utc), begin, std::max(begin, end));
  Span span{middle, middle};
  while (span.begin > begin) {
    const Mark& mark = marks_[--span.begin];
    if (mark.jumps || mark.utc <= utc - setup_.half_window) break;
  }
  while (span.end < end) {
    const Mark& mark = marks_[span.end];
    if (mark.jumps && span.end > begin) break;
    if (mark.utc > utc + ahead && span.end > middle) break;
    ++span.end;
  }
  return span;
}

/// Marks on both sides, near enough to speak for `utc`. Beside a depth event one of the two may be
/// of the other segment.
bool DepthTrack::Bracketed(UtcTime utc, Span span, UtcTime rest_begin, UtcTime rest_end) const {
  const std::size_t after = After(utc);
  if (span.begin == span.end || after == 0) return false;
  const Mark& a = marks_[after - 1];
  if (a.utc == utc) return true;
  if (after == marks_.size()) return false;
  const Mark& b = marks_[after];
  if (Segment(a.utc) != Segment(b.utc)) return b.utc - a.utc <= setup_.max_gap;
  if (b.jumps || b.utc - std::max(utc, rest_end) > setup_.max_gap) return false;
  if (b.utc - a.utc <= setup_.max_gap) return true;
  const Duration moving =
      (b.utc - a.utc) - (std::min(b.utc, rest_end) - std::max(a.utc, rest_begin));
  return (a.stopped || moving <= setup_.max_gap) && std::abs(b.md - a.md) < kRestsWithin;
}

/// What to add to the marks from `shift` on. The reading at the event is taken from marks after it
/// alone, because the system may have been set there.
double DepthTrack::Offset(const Shift& shift) const {
  const Span span = SpanAt(shift.utc, setup_.half_window);
  LocalFit fit;
  for (std::size_t i = span.begin; i < span.end; ++i) {
    const double u = Seconds(marks_[i].utc, shift.utc) / setup_.half_window.seconds();
    fit.Add(u, marks_[i].md, 1 - u * u);
  }
  if (fit.count() > 0) return shift.value - fit.Fit(1).value;
  if (span.begin == span.end) return 0;
  const Mark& next = marks_[span.begin];
  if (next.utc - shift.utc <= setup_.max_gap) return shift.value - next.md;
  const bool held = span.begin > 0 && marks_[span.begin - 1].stopped &&
                    std::abs(marks_[span.begin - 1].md - next.md) < kRestsWithin;
  return held ? shift.value - next.md : 0;
}

/// Between the marks about `utc` [s].
double DepthTrack::GapAt(UtcTime utc) const {
  const std::size_t after = After(utc);
  if (after == 0 || after == marks_.size()) return 0;
  return Seconds(marks_[after].utc, marks_[after - 1].utc);
}

/// Too far apart for any fit.
bool DepthTrack::Sparse(double gap) const {
  return gap > kDense * 2 * setup_.half_window.seconds();
}

/// How far ahead of `utc` marks are fitted.
Duration DepthTrack::AheadAt(UtcTime utc) const {
  const double ahead = setup_.ahead.seconds();
  const double dense = std::min(kDense * (setup_.half_window.seconds() + ahead), ahead);
  return GapAt(utc) <= dense ? setup_.ahead : setup_.half_window;
}

/// The monotone cubic between the two neighbours (slopes at the marks after Fritsch and Butland,
/// SIAM J. Sci. Stat. Comput. 5 (1984)), or the mark itself where it is alone. Of the marks beyond
/// the two those count that lie within max_gap of the other, and ahead where that is all that is
/// looked at.
AlongHole DepthTrack::Join(UtcTime utc, Span span) const {
  std::size_t i = std::clamp(After(utc), span.begin + 1, span.end) - 1;
  if (i + 1 == span.end && i > span.begin) --i;
  const Mark& a = marks_[i];
  const Mark& b = marks_[std::min(i + 1, span.end - 1)];
  const double h = Seconds(b.utc, a.utc);
  if (!(h > 0)) return {.md = a.md, .sigma_md = setup_.sigma_reading, .known = true};
  const double v = (b.md - a.md) / h;
  const auto slope = [](const Mark& m, const Mark& n) {
    return (n.md - m.md) / Seconds(n.utc, m.utc);
  };
  const auto joins = [&](const Mark& m, const Mark& n, UtcTime near, UtcTime far) {
    const Duration way = far < near ? near - far : far - near;
    return way <= setup_.max_gap && !n.jumps && m.utc < n.utc && Segment(m.utc) == Segment(n.utc);
  };
  double va = v, vb = v, change_a = 0, change_b = 0;
  const auto mean = [](double p, double q) { return p * q > 0 ? 2 * p * q / (p + q) : 0.0; };
  if (i > 0 && joins(marks_[i - 1], a, b.utc, marks_[i - 1].utc)) {
    const double before = slope(marks_[i - 1], a);
    va = mean(before, v);
    change_a = std::abs(v - before);
  }
  const bool looked_at =
      i + 2 < marks_.size() && (Sparse(h) || marks_[i + 2].utc <= utc + AheadAt(utc));
  if (looked_at && joins(b, marks_[i + 2], a.utc, marks_[i + 2].utc)) {
    const double beyond = slope(b, marks_[i + 2]);
    vb = mean(v, beyond);
    change_b = std::abs(beyond - v);
  }
  const double u = std::clamp(Seconds(utc, a.utc) / h, 0.0, 1.0), w = 1 - u;
  const double rise = v * h, ca = h * va - rise, cb = rise - h * vb;
  AlongHole along;
  along.md = a.md + u * rise + u * w * (w * ca + u * cb);
  along.speed = (rise + (w - u) * (w * ca + u * cb) + u * w * (cb - ca)) / h;
  along.acceleration = (2 * (1 - 3 * w) * ca + 2 * (3 * u - 1) * -cb) / (h * h);
  along.known = true;
  // What the speed may have done unseen: as much as it changes from mark to mark, and over a time
  // in which a tool is stopped and started again as much as it is.
  const bool stops = h > kStopAndGo;
  const double change = std::max({change_a, change_b, stops ? std::abs(v) : 0.0});
  along.sigma_md = std::hypot(setup_.sigma_reading, u * w * h * change / 2);
  along.sigma_speed = std::hypot(setup_.sigma_reading / h, change / 2);
  along.sigma_acceleration = (change_a + change_b) / h;
  if (stops && v != 0) along.sigma_acceleration += kUnseen;
  return along;
}

AlongHole DepthTrack::AtRest(UtcTime begin, UtcTime end) const {
  if (!IsWithinReach(begin) || !IsWithinReach(end)) return {};
  const UtcTime utc = begin + Duration{(end - begin).ns / 2};
  const Span span = SpanAt(utc, AheadAt(utc));
  if (!Bracketed(utc, span, begin, end)) return {};
  AlongHole along = Sparse(GapAt(utc)) ? Join(utc, span) : Fitted(utc, span);
  const Mark& nearest = marks_[std::clamp(After(utc), span.begin + 1, span.end) - 1];
  double sigma_event = 0;
  const auto next = std::ranges::upper_bound(shifts_, utc, {}, &Shift::utc);
  if (next != shifts_.begin()) {
    const Shift& shift = *std::prev(next);
    along.md += shift.offset ? *shift.offset : Offset(shift);
    sigma_event = shift.sigma;
  }
  along.sigma_md = std::hypot(along.sigma_md, nearest.sigma, sigma_event);
  return along;
}

void DepthTrack::Forget(UtcTime utc) {
  UtcTime keep = utc - setup_.half_window;
  for (const Shift& shift : shifts_) {
    if (!shift.offset) keep = std::min(keep, shift.utc);
  }
  // The last two marks at or before stay, to bracket what follows; more to tell of the scatter.
  const std::size_t after = After(keep);
  if (after < 3) return;
  const UtcTime first = marks_[after - 2].utc;
  forgotten_ = std::max(forgotten_.value_or(first), first);
  const std::size_t drop = after - std::min(after, kMemory);
  for (std::size_t i = 0; i < drop; ++i) {
    if (!needed_ || marks_[i].utc >= *needed_)
      deepest_forgotten_ = std::max(deepest_forgotten_, marks_[i].md);
  }
  marks_.erase(marks_.begin(), marks_.begin() + static_cast<std::ptrdiff_t>(drop));
}

}  // namespace wellgyro
