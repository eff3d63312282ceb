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

bool Within(const Eigen::Vector3d& v, double limit) { return v.cwiseAbs().maxCoeff() <= limit; }

bool IsPossible(const ImuSample& sample) {
  return sample.w_IT_T.allFinite() && Within(sample.w_IT_T, kRateLimit) && sample.f_T.allFinite() &&
         Within(sample.f_T, kForceLimit) &&
         (!sample.has_mag || (sample.b_T.allFinite() && Within(sample.b_T, kFieldLimit)));
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

SampleQueue::Verdict SampleQueue::Count(Verdict verdict) {
  switch (verdict) {
    case Verdict::kTaken:
      ++counts_.accepted;
      break;
    case Verdict::kDuplicate:
      ++counts_.duplicates;
      break;
    case Verdict::kLate:
      ++counts_.late;
      break;
    case Verdict::kRefused:
      ++counts_.refused;
      break;
  }
  return verdict;
}

bool SampleQueue::Contradicts(const ImuSample& sample) const {
  const SampleStamp* neighbour = size_ > old_session_ ? &At(size_ - 1).stamp
                                 : popped_            ? &last_
                                                      : nullptr;
  if (neighbour == nullptr || neighbour->session != sample.stamp.session) return false;
  const bool next = sample.stamp.seq == neighbour->seq + 1 &&
                    (sample.stamp.tool_time - neighbour->tool_time).ns == neighbour->period_ns &&
                    neighbour->period_ns == sample.stamp.period_ns;
  if (next) return false;
  // A tool that changes its sampling rate starts its numbers and times anew from there.
  if (neighbour->period_ns != sample.stamp.period_ns) {
    return (sample.stamp.seq > neighbour->seq) != (neighbour->tool_time < sample.stamp.tool_time);
  }
  return !SameStory(*neighbour, sample.stamp);
}

SampleQueue::Verdict SampleQueue::Push(const ImuSample& sample) {
  if (!IsPossible(sample) || sample.stamp.period_ns <= 0) return Count(Verdict::kRefused);
  const std::int32_t session = sample.stamp.session;
  const std::int32_t current = size_ > 0 ? At(size_ - 1).stamp.session
                               : popped_ ? last_.session
                                         : session;
  if (session != current) {
    old_session_ = size_;
  } else if (Contradicts(sample)) {
    return Count(Verdict::kRefused);
  }
  const std::int64_t seq = sample.stamp.seq;
  if (popped_ && last_.session == session && seq <= last_.seq) {
    return Count(InGap(seq) ? Verdict::kLate : Verdict::kDuplicate);
  }
  std::size_t position = size_;
  while (position > old_session_ && At(position - 1).stamp.seq >= seq) {
    if (At(position - 1).stamp.seq == seq) return Count(Verdict::kDuplicate);
    --position;
  }
  Insert(position, sample);
  newest_ = counts_.accepted == 0 ? sample.stamp.utc : std::max(newest_, sample.stamp.utc);
  return Count(Verdict::kTaken);
}

void SampleQueue::Insert(std::size_t position, const ImuSample& sample) {
  if (size_ == ring_.size()) {
    std::vector<ImuSample> larger(ring_.empty() ? 1024 : 2 * ring_.size());
    for (std::size_t i = 0; i < size_; ++i) larger[i] = At(i);
    ring_.swap(larger);
    head_ = 0;
  }
  ++size_;
  for (std::size_t i = size_ - 1; i > position; --i) At(i) = At(i - 1);
  At(position) = sample;
}

const ImuSample* SampleQueue::Front() const {
  if (size_ == 0) return nullptr;
  const ImuSample& front = At(0);
  if (flushing_ || old_session_ > 0 || size_ > kWaitingMax) return &front;
  return At(size_ - 1).stamp.tool_time - front.stamp.tool_time >= hold_ ? &front : nullptr;
}

bool SampleQueue::InGap(std::int64_t seq) const {
  return std::any_of(gaps_.begin(), gaps_.end(),
                     [seq](const auto& gap) { return gap.first <= seq && seq < gap.second; });
}

void SampleQueue::Pop() {
  assert(size_ > 0);
  const SampleStamp& stamp = At(0).stamp;
  if (popped_ && stamp.session != last_.session) gaps_.clear();
  if (popped_ && stamp.session == last_.session && stamp.seq > last_.seq + 1) {
    if (gaps_.size() == kGapsKept) gaps_.erase(gaps_.begin());
    gaps_.emplace_back(last_.seq + 1, stamp.seq);
  }
  last_ = stamp;
  popped_ = true;
  head_ = (head_ + 1) & (ring_.size() - 1);
  --size_;
  if (old_session_ > 0) --old_session_;
}

}  // namespace wellgyro
