#include "wellgyro/calibration/spike_filter.h"

#include <algorithm>
#include <cmath>

namespace wellgyro {
namespace {

constexpr double kShared = 2.0 / 3;
constexpr double kTimes = 10;    // what the neighbours have that is no spike's
constexpr double kSpreads = 3;   // of the neighbours
constexpr double kSigmas = 8.4;  // of the stated noise: six of that of a sample less its cubic
// What is less does no harm, and a tool without noise is no tool.
constexpr double kLeastRate = 1e-5;   // [rad/s]
constexpr double kLeastForce = 1e-3;  // [m/s^2]

}  // namespace

bool SpikeFilter::Continues(const SampleStamp& stamp) const {
  if (waiting_ == 0) return false;
  const SampleStamp& last = At(size_ - 1).sample.stamp;
  return stamp.session == last.session && stamp.seq == last.seq + 1 &&
         stamp.period_ns == last.period_ns;
}

const SpikeFilter::Out* SpikeFilter::Push(const ImuSample& sample, bool mark) {
  if (size_ == kWindow) {
    first_ = (first_ + 1) % kWindow;
    --size_;
  }
  Out& out = At(size_);
  ++size_;
  ++waiting_;
  out.sample = sample;
  out.mark = mark;
  out.gyro = out.accel = false;
  if (waiting_ <= kMiddle) return nullptr;
  if (size_ == kWindow) MendMiddle();
  return &At(size_ - waiting_--);
}

const SpikeFilter::Out* SpikeFilter::Flush() {
  if (waiting_ == 0) {
    size_ = 0;
    return nullptr;
  }
  return &At(size_ - waiting_--);
}

/// One axis of the sample in the middle; `value` gives it of a sample.
template <class Value>
bool SpikeFilter::MendAxis(double floor, Value value) {
  const auto at = [&](std::size_t i) { return value(At(i).sample); };
  // What a sample has that the cubic through the four about it has not.
  const auto beyond = [&](std::size_t i) {
    return at(i) - (4 * (at(i - 1) + at(i + 1)) - at(i - 2) - at(i + 2)) / 6;
  };
  const double off = beyond(kMiddle);
  // Nearly all samples are done with this.
  if (std::abs(off) <= floor) return false;
  double& x = value(At(kMiddle).sample);
  // A single bad sample leaves -2/3 of itself with either neighbour; what else these have is how
  // much the signal itself departs from cubics here.
  const double lively = std::max(std::abs(beyond(kMiddle - 1) + off * kShared),
                                 std::abs(beyond(kMiddle + 1) + off * kShared));
  if (std::abs(off) > kTimes * lively + floor) {
    x -= off;
    return true;
  }
  std::array<double, 6> near{at(0), at(1), at(2), at(4), at(5), at(6)};
  std::sort(near.begin(), near.end());
  const double median = (near[2] + near[3]) / 2;
  if (!(std::abs(x - median) > kSpreads * (near[4] - near[1]) + floor)) return false;
  x = median;
  return true;
}

void SpikeFilter::MendMiddle() {
  Out& out = At(kMiddle);
  const double rate = 1 / std::sqrt(1e-9 * static_cast<double>(out.sample.stamp.period_ns));
  const double gyro_floor = kSigmas * gyro_noise_ * rate + kLeastRate;
  const double accel_floor = kSigmas * accel_noise_ * rate + kLeastForce;
  const int axes = out.sample.has_gz ? 3 : 2;
  for (int axis = 0; axis < axes; ++axis) {
    const auto value = [axis](auto& sample) -> auto& { return sample.w_IT_T[axis]; };
    if (MendAxis(gyro_floor, value)) out.gyro = true;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const auto value = [axis](auto& sample) -> auto& { return sample.f_T[axis]; };
    if (MendAxis(accel_floor, value)) out.accel = true;
  }
}

}  // namespace wellgyro
