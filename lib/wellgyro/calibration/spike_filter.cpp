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
    first_ = (first_ + 1) % kRing;
    --size_;
  }
  Out& out = At(size_);
  values_[Slot(size_)] << sample.w_IT_T, sample.f_T;
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

void SpikeFilter::SetFloor(std::int32_t period_ns) {
  if (period_ns == floor_period_ns_) return;
  floor_period_ns_ = period_ns;
  const double rate = 1 / std::sqrt(1e-9 * static_cast<double>(period_ns));
  floor_.head<3>() = kSigmas * gyro_noise_ * rate + kLeastRate;
  floor_.tail<3>() = kSigmas * accel_noise_ * rate + kLeastForce;
}

/// What a sample has that the cubic through the four about it has not.
SpikeFilter::Values SpikeFilter::Beyond(std::size_t i) const {
  const Values near = 4 * (ValuesAt(i - 1) + ValuesAt(i + 1)) - ValuesAt(i - 2) - ValuesAt(i + 2);
  return ValuesAt(i) - near / 6;
}

/// One axis of the sample in the middle, which has `off` that its cubic has not.
bool SpikeFilter::MendAxis(Eigen::Index axis, double off) {
  const double floor = floor_[axis];
  double& x = values_[Slot(kMiddle)][axis];
  // A single bad sample leaves -2/3 of itself with either neighbour; what else these have is how
  // much the signal itself departs from cubics here.
  const double lively = std::max(std::abs(Beyond(kMiddle - 1)[axis] + off * kShared),
                                 std::abs(Beyond(kMiddle + 1)[axis] + off * kShared));
  if (std::abs(off) > kTimes * lively + floor) {
    x -= off;
    return true;
  }
  std::array<double, 6> near;
  for (std::size_t i = 0; i < near.size(); ++i) near[i] = ValuesAt(i < kMiddle ? i : i + 1)[axis];
  std::sort(near.begin(), near.end());
  const double median = (near[2] + near[3]) / 2;
  if (!(std::abs(x - median) > kSpreads * (near[4] - near[1]) + floor)) return false;
  x = median;
  return true;
}

void SpikeFilter::MendMiddle() {
  Out& out = At(kMiddle);
  SetFloor(out.sample.stamp.period_ns);
  const Values off = Beyond(kMiddle);
  // Nearly all samples are done with this.
  if ((off.abs() <= floor_).all()) return;
  for (Eigen::Index axis = 0; axis < off.size(); ++axis) {
    const bool there = axis != 2 || out.sample.has_gz;
    if (!there || std::abs(off[axis]) <= floor_[axis] || !MendAxis(axis, off[axis])) continue;
    (axis < 3 ? out.gyro : out.accel) = true;
  }
  const Values& mended = ValuesAt(kMiddle);
  out.sample.w_IT_T = mended.head<3>();
  out.sample.f_T = mended.tail<3>();
}

}  // namespace wellgyro
