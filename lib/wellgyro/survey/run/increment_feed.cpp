#include "wellgyro/survey/run/increment_feed.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wellgyro {
namespace {

IncrementOptions IncrementOptionsOf(const Job& job) {
  IncrementOptions options;
  options.order = job.attitude.order == AttitudeSpec::Order::kSecond ? IncrementOptions::kSecond
                                                                     : IncrementOptions::kThird;
  options.accel_noise = job.errors.accel_noise;
  options.angle_random_walk = job.noise.angle_random_walk;
  if (job.errors.accel_bias_sigma > 0) options.accel_bias = job.errors.accel_bias_sigma;
  return options;
}

}  // namespace

IncrementFeed::IncrementFeed(const Job& job) : builder_(IncrementOptionsOf(job)) {}

void IncrementFeed::Push(const ImuSample& sample, bool rests) {
  builder_.Push(sample, rests);
  for (const Duration into : gap_cuts_) builder_.CutGap(into);
  gap_cuts_.clear();
}

void IncrementFeed::Cut(double fraction, std::int32_t period_ns) {
  if (fraction <= 1) {
    builder_.Cut(fraction);
  } else {
    gap_cuts_.push_back(Duration{std::llround((fraction - 1) * period_ns)});
  }
}

void IncrementFeed::Give(const std::function<UtcTime(ToolTime)>& utc_of, WaitingKnots& waiting) {
  if (!builder_.Ready()) return;
  auto next = std::find_if(waiting.begin(), waiting.end(),
                           [](const WaitingKnot& knot) { return !knot.increment.has_value(); });
  while (builder_.Ready()) {
    Increment increment = builder_.Pop();
    const bool asked = next != waiting.end() && next->end.ns <= increment.time.ns + kSameNs;
    if (!asked) {
      WaitingKnot own;
      own.end = increment.time;
      own.begin = own.end - Duration::Seconds(increment.seconds);
      own.utc = utc_of(own.end);
      next = waiting.insert(next, own);
    }
    next->increment = std::move(increment);
    ++next;
  }
}

std::vector<Increment> IncrementFeed::Ahead(const WaitingKnots& waiting) {
  std::vector<Increment> increments;
  ahead_ = builder_;
  ahead_->Flush();
  for (const WaitingKnot& knot : waiting) {
    if (knot.increment) {
      increments.push_back(*knot.increment);
      continue;
    }
    if (!ahead_->Ready()) break;
    increments.push_back(ahead_->Pop());
    if (std::abs((increments.back().time - knot.end).ns) > kSameNs) {
      increments.pop_back();  // the builder's own, or one that ends in a gap
      break;
    }
  }
  return increments;
}

}  // namespace wellgyro
