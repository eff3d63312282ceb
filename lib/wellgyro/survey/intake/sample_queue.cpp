#include "wellgyro/survey/intake/sample_queue.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>

#include "wellgyro/base/time_range.h"

namespace wellgyro {
namespace {

// No tool turns or falls like that: a hundred turns a second, a thousand g, ten times a magnet.
constexpr double kRateLimit = 700;   // [rad/s]
constexpr double kForceLimit = 1e4;  // [m/s^2]
constexpr double kFieldLimit = 10;   // [T]

// By no more does a sample differ that was made SI again at the temperature of another batch: 4
// deg/h and 1 mg. As floats, in which they are kept, 100 rad/s are rounded to 4e-6 and 1000 m/s^2
// to 3e-5.
constexpr float kSameRate = 2e-5F;   // [rad/s]
constexpr float kSameForce = 0.01F;  // [m/s^2]

/// Where a number that is kept has its place.
std::size_t Slot(std::int64_t seq) {
  return static_cast<std::size_t>(seq / SampleQueue::kKeptEvery) & (SampleQueue::kKept - 1);
}

// False also for what is no number.
bool Within(const Eigen::Vector3d& v, double limit) { return v.squaredNorm() <= limit * limit; }

bool IsPossible(const ImuSample& sample) {
  const SampleStamp& stamp = sample.stamp;
  const bool counted = IsWithinReach(stamp.tool_time) && IsWithinReach(stamp.utc) &&
                       IsWithinReach(stamp.seq) && stamp.period_ns > 0;
  return counted && Within(sample.w_IT_T, kRateLimit) && Within(sample.f_T, kForceLimit) &&
         (!sample.has_mag || Within(sample.b_T, kFieldLimit));
}

// Sequence numbers and tool time tell the same story if the step in time is the step in number
// times the period, to half a period and a hundred parts per million for a drifting crystal.
bool SameStory(const SampleStamp& a, const SampleStamp& b) {
  const double periods = static_cast<double>(b.seq - a.seq);
  const double time = static_cast<double>((b.tool_time - a.tool_time).ns);
  const double period = static_cast<double>(a.period_ns);
  return std::abs(time - periods * period) <= period * (0.5 + 1e-4 * std::abs(periods));
}

// What `b` says in UTC beside `a`, against the tool's clock: to a second of delayed messages and
// two hundred parts per million of drift.
bool SameUtc(const SampleStamp& a, const SampleStamp& b) {
  if (a.utc == b.utc) return true;  // it does not say
  const double tool = static_cast<double>((b.tool_time - a.tool_time).ns);
  const double utc = static_cast<double>((b.utc - a.utc).ns);
  return std::abs(utc - tool) <= 1e9 + 2e-4 * std::abs(tool);
}

/// Into the nearest cache.
void Fetch(const ImuSample& sample) {
  const auto bytes = std::as_bytes(std::span(&sample, 1));
  for (std::size_t i = 0; i + kCacheLine <= bytes.size(); i += kCacheLine) {
    __builtin_prefetch(&bytes[i]);
  }
}

/// `b` cannot be of the same count and clock as `a`.
bool Contradicts(const SampleStamp& a, const SampleStamp& b) {
  if (a.session != b.session) return true;
  // A tool that changes its sampling rate starts its numbers and times anew from there.
  if (a.period_ns != b.period_ns) return (b.seq > a.seq) != (a.tool_time < b.tool_time);
  if (!SameStory(a, b)) return true;
  // UTC may step; but where number and clock leap together, it tells a loss from nonsense.
  const Duration apart = b.tool_time - a.tool_time;
  return std::max(apart, Duration{-apart.ns}) > SampleQueue::kAgree && !SameUtc(a, b);
}

}  // namespace

SampleQueue::Verdict SampleQueue::Push(const ImuSample& sample) {
  if (!IsPossible(sample)) {
    ++counts_.refused;
    return Verdict::kRefused;
  }
  const Verdict verdict = Sort(sample);
  if (!stories_.empty()) DropOld();
  return verdict;
}

std::span<const ImuSample> SampleQueue::Ready() const {
  std::size_t n = std::min({size_, ring_.size() - head_, SampleBlock::kMost});
  if (n == 0) return {};
  if (old_session_ > 0) {
    n = std::min(n, old_session_);
  } else if (!flushing_ && size_ > kWaitingMax) {
    n = std::min(n, size_ - kWaitingMax);
  } else if (!flushing_) {
    const SampleStamp& first = At(0).stamp;
    if (Age(first) < hold_) return {};
    // As many as there are where none is missing; where one is, the first is sure.
    const std::int64_t even = (Age(first) - hold_).ns / first.period_ns + 1;
    n = static_cast<std::size_t>(std::min(even, static_cast<std::int64_t>(n)));
    if (Age(At(n - 1).stamp) < hold_) n = 1;
  }
  if (!jumps_.empty()) {
    const std::int64_t before = jumps_.front() - (counts_.accepted - Waiting());
    n = std::min(n, static_cast<std::size_t>(std::max<std::int64_t>(before, 1)));
  }
  return {ring_.data() + head_, n};
}

void SampleQueue::Pop(std::size_t count) {
  const SampleStamp& first = At(0).stamp;
  const SampleStamp& last = At(count - 1).stamp;
  const bool jumps = Jumps();
  const bool next = last_ && first.seq == last_->seq + 1 && first.session == last_->session;
  if (!next || jumps) NoteGap(first, jumps);
  last_ = {last.seq, last.session};
  for (std::size_t i = 0; i < count; i += kKeptEvery) {
    const std::int64_t past = (At(i).stamp.seq % kKeptEvery + kKeptEvery) % kKeptEvery;
    const std::size_t kept = i + static_cast<std::size_t>(past == 0 ? 0 : kKeptEvery - past);
    if (kept < count) Keep(At(kept));
  }
  head_ = (head_ + count) & mask_;
  size_ -= count;
  held_ += count;
  last_is_old_ = old_session_ > 0;
  old_session_ -= std::min(old_session_, count);
}

std::span<ImuSample> SampleQueue::Held() {
  const std::size_t first = (head_ - held_) & mask_;
  return {ring_.data() + first, std::min(held_, ring_.size() - first)};
}

std::size_t SampleQueue::Append(std::span<const ImuSample> batch) {
  if (!back_ || !stories_.empty()) return 0;
  while (room() < batch.size()) Grow();
  const SampleStamp* before = &*back_;
  UtcTime newest = newest_;
  std::size_t n = 0;
  // At 10 kHz the ring is larger than the near caches. So each is copied while the next is looked
  // at, and as many of the oldest, which these let go, are on their way meanwhile. Times out of
  // reach must not be subtracted.
  for (; n < batch.size() && IsPossible(batch[n]) && IsNext(*before, batch[n].stamp); ++n) {
    before = &batch[n].stamp;
    newest = std::max(newest, before->utc);
    At(size_ + n) = batch[n];
    Fetch(At(n));
  }
  newest_ = newest;
  size_ += n;
  counts_.accepted += static_cast<std::int64_t>(n);
  back_ = *before;
  if (n > 0) other_ = false;
  return n;
}

SampleQueue::Verdict SampleQueue::Sort(const ImuSample& sample) {
  const SampleStamp& stamp = sample.stamp;
  const std::int64_t seq = stamp.seq;
  if (back_ && Contradicts(*back_, stamp)) return PutAside(sample);
  if (last_ && !last_is_old_ && seq <= last_->seq) {
    if (InGap(seq)) {
      ++counts_.late;
      return Verdict::kLate;
    }
    const bool compared = seq % kKeptEvery == 0 && !kept_.empty();
    return Again(sample, compared ? &kept_[Slot(seq)] : nullptr);
  }
  std::size_t position = size_;
  while (position > old_session_ && At(position - 1).stamp.seq >= seq) {
    if (At(position - 1).stamp.seq == seq) {
      const Content first = ContentOf(At(position - 1));
      return Again(sample, &first);
    }
    --position;
  }
  Take(position, sample);
  return Verdict::kTaken;
}

SampleQueue::Content SampleQueue::ContentOf(const ImuSample& sample) {
  const SampleStamp& stamp = sample.stamp;
  return {stamp.seq, stamp.tool_time, stamp.session, sample.w_IT_T.cast<float>(),
          sample.f_T.cast<float>()};
}

void SampleQueue::Keep(const ImuSample& sample) {
  if (kept_.empty()) kept_.resize(kKept);
  kept_[Slot(sample.stamp.seq)] = ContentOf(sample);
}

/// A sample whose number has been before, perhaps as `first`.
SampleQueue::Verdict SampleQueue::Again(const ImuSample& sample, const Content* first) {
  const Content again = ContentOf(sample);
  if (first != nullptr && first->seq == again.seq && first->session == again.session &&
      first->time == again.time) {
    other_ = (first->w_IT_T - again.w_IT_T).cwiseAbs().maxCoeff() > kSameRate ||
             (first->f_T - again.f_T).cwiseAbs().maxCoeff() > kSameForce;
  }
  ++(other_ ? counts_.others : counts_.duplicates);
  return other_ ? Verdict::kOther : Verdict::kDuplicate;
}

SampleQueue::Verdict SampleQueue::PutAside(const ImuSample& sample) {
  for (Story& story : stories_) {
    if (!Contradicts(story.samples.back().stamp, sample.stamp)) return Join(story, sample);
  }
  if (stories_.size() == kStoriesMax) Drop(1);
  stories_.push_back({{sample}, back_->tool_time, back_->tool_time});
  return Verdict::kAside;
}

SampleQueue::Verdict SampleQueue::Join(Story& story, const ImuSample& sample) {
  std::vector<ImuSample>& samples = story.samples;
  const std::int64_t seq = sample.stamp.seq;
  auto at = samples.end();
  while (at != samples.begin() && std::prev(at)->stamp.seq >= seq) --at;
  if (at != samples.end() && at->stamp.seq == seq) {
    ++counts_.duplicates;
    return Verdict::kDuplicate;
  }
  if (samples.size() == 2 * kAgreeMax) {
    ++counts_.strays;
    return Verdict::kRefused;
  }
  samples.insert(at, sample);
  story.alone = story.heard == back_->tool_time ? story.alone + 1 : 1;
  story.heard = back_->tool_time;
  const Duration filled{static_cast<std::int64_t>(story.alone) * sample.stamp.period_ns};
  if (filled < kAgree && story.alone < kAgreeMax) return Verdict::kAside;
  Believe(std::move(story));
  return Verdict::kTaken;
}

/// A new session begins behind what is queued.
void SampleQueue::Begin() {
  Drop(stories_.size());
  old_session_ = size_;
  last_is_old_ = true;
}

/// The samples put aside (`story`) become the stream: the clock has jumped, or a session begun.
void SampleQueue::Believe(Story story) {
  const bool same_session = story.samples.front().stamp.session == back_->session;
  if (same_session) jumps_.push_back(counts_.accepted);
  Begin();
  for (const ImuSample& sample : story.samples) Take(size_, sample);
}

/// Counts the oldest `stories` put aside as strays and forgets them.
void SampleQueue::Drop(std::size_t stories) {
  const auto end = stories_.begin() + static_cast<std::ptrdiff_t>(stories);
  for (auto story = stories_.begin(); story != end; ++story) {
    counts_.strays += static_cast<std::int64_t>(story->samples.size());
  }
  stories_.erase(stories_.begin(), end);
}

void SampleQueue::DropOld() {
  const ToolTime now = back_->tool_time;
  std::size_t old = 0;
  while (old < stories_.size() && now - stories_[old].begun >= kAgree) ++old;
  Drop(old);
}

void SampleQueue::Take(std::size_t position, const ImuSample& sample) {
  if (room() == 0) Grow();
  for (std::size_t i = size_; i > position; --i) At(i) = At(i - 1);
  if (position == size_) back_ = sample.stamp;
  ++size_;
  At(position) = sample;
  other_ = false;
  newest_ = counts_.accepted == 0 ? sample.stamp.utc : std::max(newest_, sample.stamp.utc);
  ++counts_.accepted;
}

void SampleQueue::Grow() {
  std::vector<ImuSample> larger(ring_.empty() ? 1024 : 2 * ring_.size());
  for (std::size_t i = 0; i < held_ + size_; ++i) larger[i] = ring_[(head_ - held_ + i) & mask_];
  ring_.swap(larger);
  mask_ = ring_.size() - 1;
  head_ = held_;
}

bool SampleQueue::InGap(std::int64_t seq) const {
  return std::any_of(gaps_.begin(), gaps_.end(),
                     [seq](const auto& gap) { return gap.first <= seq && seq < gap.second; });
}

void SampleQueue::NoteGap(const SampleStamp& next, bool jumps) {
  if (jumps) jumps_.erase(jumps_.begin());
  const bool begins = !last_ || next.session != last_->session;
  if (jumps || begins) {
    gaps_.clear();
    // What is older than the first of a session has never been here.
    if (begins) gaps_.emplace_back(std::numeric_limits<std::int64_t>::min(), next.seq);
  } else if (next.seq > last_->seq + 1) {
    if (gaps_.size() == kGapsKept) gaps_.erase(gaps_.begin());
    gaps_.emplace_back(last_->seq + 1, next.seq);
  }
}

}  // namespace wellgyro
