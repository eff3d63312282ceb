#include "wellgyro/survey/sample_queue.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>

namespace wellgyro {
namespace {

// No tool turns or falls like that: a hundred turns a second, a thousand g, ten times a magnet.
constexpr double kRateLimit = 700;   // [rad/s]
constexpr double kForceLimit = 1e4;  // [m/s^2]
constexpr double kFieldLimit = 10;   // [T]

// False also for what is no number.
bool Within(const Eigen::Vector3d& v, double limit) {
  return std::abs(v.x()) <= limit && std::abs(v.y()) <= limit && std::abs(v.z()) <= limit;
}

bool IsPossible(const ImuSample& sample) {
  return sample.stamp.period_ns > 0 && Within(sample.w_IT_T, kRateLimit) &&
         Within(sample.f_T, kForceLimit) && (!sample.has_mag || Within(sample.b_T, kFieldLimit));
}

// Sequence numbers and tool time tell the same story if the step in time is the step in number
// times the period, to half a period and a hundred parts per million for a drifting crystal.
bool SameStory(const SampleStamp& a, const SampleStamp& b) {
  const double periods = static_cast<double>(b.seq - a.seq);
  const double time = static_cast<double>((b.tool_time - a.tool_time).ns);
  const double period = static_cast<double>(a.period_ns);
  return std::abs(time - periods * period) <= period * (0.5 + 1e-4 * std::abs(periods));
}

}  // namespace

/// Right behind the last one that came: nothing is to be sorted.
inline bool SampleQueue::IsNext(const SampleStamp& stamp) const {
  if (size_ == 0 && !popped_) return false;
  const SampleStamp& before = size_ > 0 ? At(size_ - 1).stamp : last_;
  return stamp.seq == before.seq + 1 && stamp.session == before.session &&
         stamp.period_ns == before.period_ns &&
         (stamp.tool_time - before.tool_time).ns == before.period_ns;
}

bool SampleQueue::Contradicts(const ImuSample& sample) const {
  const SampleStamp* neighbour = size_ > old_session_ ? &At(size_ - 1).stamp
                                 : popped_            ? &last_
                                                      : nullptr;
  if (neighbour == nullptr || neighbour->session != sample.stamp.session) return false;
  // A tool that changes its sampling rate starts its numbers and times anew from there.
  if (neighbour->period_ns != sample.stamp.period_ns) {
    return (sample.stamp.seq > neighbour->seq) != (neighbour->tool_time < sample.stamp.tool_time);
  }
  return !SameStory(*neighbour, sample.stamp);
}

SampleQueue::Verdict SampleQueue::Push(const ImuSample& sample) {
  if (!IsPossible(sample)) {
    ++counts_.refused;
    return Verdict::kRefused;
  }
  if (!IsNext(sample.stamp)) return Sort(sample);
  Take(size_, sample);
  return Verdict::kTaken;
}

SampleQueue::Verdict SampleQueue::Sort(const ImuSample& sample) {
  const std::int32_t session = sample.stamp.session;
  const std::int32_t current = size_ > 0 ? At(size_ - 1).stamp.session
                               : popped_ ? last_.session
                                         : session;
  if (session != current) {
    old_session_ = size_;
  } else if (Contradicts(sample)) {
    ++counts_.refused;
    return Verdict::kRefused;
  }
  const std::int64_t seq = sample.stamp.seq;
  if (popped_ && last_.session == session && seq <= last_.seq) {
    const bool late = InGap(seq);
    ++(late ? counts_.late : counts_.duplicates);
    return late ? Verdict::kLate : Verdict::kDuplicate;
  }
  std::size_t position = size_;
  while (position > old_session_ && At(position - 1).stamp.seq >= seq) {
    if (At(position - 1).stamp.seq == seq) {
      ++counts_.duplicates;
      return Verdict::kDuplicate;
    }
    --position;
  }
  Take(position, sample);
  return Verdict::kTaken;
}

inline void SampleQueue::Take(std::size_t position, const ImuSample& sample) {
  if (size_ == ring_.size()) Grow();
  for (std::size_t i = size_; i > position; --i) At(i) = At(i - 1);
  ++size_;
  At(position) = sample;
  newest_ = counts_.accepted == 0 ? sample.stamp.utc : std::max(newest_, sample.stamp.utc);
  ++counts_.accepted;
}

void SampleQueue::Grow() {
  std::vector<ImuSample> larger(ring_.empty() ? 1024 : 2 * ring_.size());
  for (std::size_t i = 0; i < size_; ++i) larger[i] = At(i);
  ring_.swap(larger);
  mask_ = ring_.size() - 1;
  head_ = 0;
}

bool SampleQueue::InGap(std::int64_t seq) const {
  return std::any_of(gaps_.begin(), gaps_.end(),
                     [seq](const auto& gap) { return gap.first <= seq && seq < gap.second; });
}

void SampleQueue::NoteGap(const SampleStamp& next) {
  if (next.session != last_.session) {
    gaps_.clear();
  } else if (next.seq > last_.seq + 1) {
    if (gaps_.size() == kGapsKept) gaps_.erase(gaps_.begin());
    gaps_.emplace_back(last_.seq + 1, next.seq);
  }
}

}  // namespace wellgyro
