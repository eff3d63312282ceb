#include "wellgyro/calibration/spike_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wellgyro {
namespace {

constexpr double kShared = 2.0 / 3;  // weight 4/6 of a neighbour in the cubic through four
// Over what the neighbours depart from their cubics without the spike. Of a tone w, in radians a
// sample, that is |cos w + 2/3| of the departure at a crest: 2/3 and more below a quarter of the
// sampling rate, but less than a tenth from 0.346 to 0.389 of it, where crests pass for spikes.
constexpr double kTimes = 10;
// Of the middle four of six neighbours, 1.28 sigma of white noise on average (order statistics):
// 3.9 sigma.
constexpr double kSpreads = 3;
// Of the stated noise: 6 sqrt(1 + (4^2 + 4^2 + 1 + 1) / 6^2), six sigmas of a sample less its
// cubic, P = 2e-9: of six axes at 100 Hz one sample in ten days.
constexpr double kSigmas = 8.4;
// Of pulses of d that are counted, with what is left carried to the next sample: rate errors are
// differences of rests within d/2, of which a sample less its cubic has (1 + 5 + 10 + 10 + 5 + 1)/6
// at most; d = sqrt(12) Q.
constexpr double kPulses = 32.0 / 6 / 2 * 3.4641016151377544;
// What is less does no harm, and a tool without noise is no tool.
constexpr double kLeastRate = 1e-5;   // [rad/s]
constexpr double kLeastForce = 1e-3;  // [m/s^2]

bool Follows(const SampleStamp& a, const SampleStamp& b) {
  return b.session == a.session && b.seq == a.seq + 1 && b.period_ns == a.period_ns;
}

}  // namespace

bool SpikeFilter::Continues(const SampleStamp& stamp) const {
  return done_ < size_ && Follows(last_, stamp);
}

SpikeFilter::Done SpikeFilter::Push(std::span<const ImuSample> samples) {
  Drop();
  const std::size_t before = size_;
  SetFloor(samples.front().stamp.period_ns);
  const SampleStamp* last = nullptr;
  std::size_t size = before;
  for (const ImuSample& sample : samples.first(std::min(samples.size(), kMost))) {
    if (last != nullptr && !Follows(*last, sample.stamp)) break;
    last = &sample.stamp;
    axes_[size] = AxesOf(sample);
    mended_[size] = {};
    has_gz_[size++] = sample.has_gz;
  }
  size_ = size;
  last_ = *last;
  const std::size_t end = std::max(size_, kMiddle) - kMiddle, begin = std::max(done_, kMiddle);
  if (begin < end && AnyDeparts(begin, end)) {
    for (std::size_t i = begin; i < end; ++i) Mend(i);
  }
  Done done = DoneUpTo(std::max(done_, end));
  done.taken = size_ - before;
  return done;
}

SpikeFilter::Done SpikeFilter::Flush() { return DoneUpTo(size_); }

SpikeFilter::Done SpikeFilter::DoneUpTo(std::size_t end) {
  const std::size_t begin = std::exchange(done_, end), count = end - begin;
  return {std::span(axes_).subspan(begin, count), std::span(mended_).subspan(begin, count), 0};
}

/// What no window needs any more: all, where nothing waits.
void SpikeFilter::Drop() {
  const std::size_t first = done_ == size_ ? size_ : std::max(done_, kMiddle) - kMiddle;
  std::copy(axes_.begin() + first, axes_.begin() + size_, axes_.begin());
  std::copy(mended_.begin() + first, mended_.begin() + size_, mended_.begin());
  std::copy(has_gz_.begin() + first, has_gz_.begin() + size_, has_gz_.begin());
  size_ -= first;
  done_ -= first;
}

void SpikeFilter::SetFloor(std::int32_t period_ns) {
  if (period_ns == floor_period_ns_) return;
  floor_period_ns_ = period_ns;
  const double seconds = 1e-9 * static_cast<double>(period_ns), rate = 1 / std::sqrt(seconds);
  SixAxes floor;
  floor.head<3>() =
      kSigmas * gyro_noise_ * rate + kPulses * gyro_quantization_ / seconds + kLeastRate;
  floor.tail<3>() = kSigmas * accel_noise_ * rate + kLeastForce;
  floors_.fill(floor);
}

/// What a sample has that the cubic through the four about it has not.
SixAxes SpikeFilter::Beyond(std::size_t i) const {
  const SixAxes near = 4 * (axes_[i - 1] + axes_[i + 1]) - axes_[i - 2] - axes_[i + 2];
  return axes_[i] - near / 6;
}

/// False: Beyond() is within the floor on every axis of samples [begin, end). Nearly all blocks
/// are done with this.
bool SpikeFilter::AnyDeparts(std::size_t begin, std::size_t end) const {
  constexpr double kSurely = 5.99;  // of the six by which the terms are multiplied, for rounding
  using Axes = Eigen::Map<const Eigen::ArrayXd>;
  const auto count = static_cast<Eigen::Index>(6 * (end - begin));
  const auto from = [&](std::size_t i) { return Axes(axes_[i].data(), count); };
  const auto near = 4 * (from(begin - 1) + from(begin + 1)) - from(begin - 2) - from(begin + 2);
  const auto floor = Axes(floors_.front().data(), count);
  return ((6 * from(begin) - near).abs() - kSurely * floor).maxCoeff() > 0;
}

/// One axis of a sample, which has `off` that its cubic has not.
bool SpikeFilter::MendAxis(std::size_t i, Eigen::Index axis, double off) {
  const double floor = floors_.front()[axis];
  double& x = axes_[i][axis];
  // A single bad sample leaves -2/3 of itself with either neighbour; what else these have is how
  // much the signal itself departs from cubics here.
  const double lively = std::max(std::abs(Beyond(i - 1)[axis] + off * kShared),
                                 std::abs(Beyond(i + 1)[axis] + off * kShared));
  if (std::abs(off) > kTimes * lively + floor) {
    x -= off;
    return true;
  }
  std::array<double, 2 * kMiddle> near;
  for (std::size_t k = 0; k < near.size(); ++k) {
    near[k] = axes_[i - kMiddle + (k < kMiddle ? k : k + 1)][axis];
  }
  std::sort(near.begin(), near.end());
  const double median = (near[2] + near[3]) / 2;
  if (!(std::abs(x - median) > kSpreads * (near[4] - near[1]) + floor)) return false;
  x = median;
  return true;
}

void SpikeFilter::Mend(std::size_t i) {
  const SixAxes off = Beyond(i);
  for (Eigen::Index axis = 0; axis < off.size(); ++axis) {
    const bool there = axis != 2 || has_gz_[i];
    if (!there || std::abs(off[axis]) <= floors_.front()[axis] || !MendAxis(i, axis, off[axis]))
      continue;
    (axis < 3 ? mended_[i].gyro : mended_[i].accel) = true;
  }
}

}  // namespace wellgyro
