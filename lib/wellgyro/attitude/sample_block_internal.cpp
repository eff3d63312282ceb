#include "wellgyro/attitude/sample_block_internal.h"

#include <cmath>

namespace wellgyro::increment {
namespace {

// (x/2) / sin(x/2): what the mean over a period that turns by x falls short of.
double InverseSinc(double x) {
  const double q = x * x;
  if (q < 0.01) return 1 + q * (1. / 24 + q * (7. / 5760));  // to 3e-11
  return 0.5 * x / std::sin(0.5 * x);
}

// Of a channel that turns by e^{ix}, x = rate t + bend t^2 / 2, about the block's middle.
struct Turned {
  Complex zeroth, first;
};
Turned Turn(const Moments& m, double rate, double bend) {
  return {Complex(m.zeroth - 0.5 * rate * rate * m.second, rate * m.first + 0.5 * bend * m.second),
          Complex(m.first, rate * m.second)};
}

}  // namespace

void BlockSum::Add(const ImuSample& sample, bool rests) {
  if (samples_ == 0) seq_begin_ = sample.stamp.seq;
  const SixAxes axes = AxesOf(sample);
  const double k = samples_++;
  sum_[0] += axes;
  sum_[1] += k * axes;
  sum_[2] += k * k * axes;
  Note(sample, sample.stamp, rests);
}

void BlockSum::Add(const SampleBlock& samples, bool rest) {
  if (samples_ == 0) seq_begin_ = samples.first().seq;
  auto [zeroth, first, second] = sum_;
  for (const SixAxes& axes : samples.axes) {
    const double k = samples_++;
    zeroth += axes;
    first += k * axes;
    second += k * k * axes;
  }
  sum_ = {zeroth, first, second};
  Note(samples.samples.front(), samples.last(), rest);
}

void BlockSum::Note(const ImuSample& like, const SampleStamp& last, bool rest) {
  const SampleStamp& stamp = like.stamp;
  accel_full_scale_ |= stamp.accel_saturated;
  gyro_full_scale_ |= stamp.gyro_saturated;
  has_gz_ &= like.has_gz;
  rests_ &= rest;
  if (stamp.gyro_saturated | stamp.accel_saturated) quality_ |= Quality::kSaturated;
  if (stamp.utc_unsynced) quality_ |= Quality::kClock;
  if (stamp.temperature_outside) quality_ |= Quality::kTemperature;
  last_ = last;
}

void BlockSum::Close(Block& block) {
  block.samples = samples_;
  block.length_ns = static_cast<std::int64_t>(samples_) * last_.period_ns;
  block.seconds = 1e-9 * static_cast<double>(block.length_ns);
  block.period = 1e-9 * last_.period_ns;
  block.seq_begin = seq_begin_;
  block.seq_end = last_.seq + 1;
  block.accel_full_scale = accel_full_scale_;
  block.gyro_full_scale = gyro_full_scale_;
  block.rests = rests_;
  block.has_gz = has_gz_;
  block.quality = quality_;
  const double dt = block.period, middle = 0.5 * (samples_ - 1);
  for (int i = 0; i < kChannels; ++i) {
    const double zeroth = sum_[0][i], first = sum_[1][i] - middle * zeroth;
    const double second = sum_[2][i] - middle * (2 * first + middle * zeroth);
    block.sum[i] = {zeroth * dt, first * dt * dt, second * dt * dt * dt};
  }
  sum_.fill(SixAxes::Zero());
  samples_ = 0;
  accel_full_scale_ = gyro_full_scale_ = false;
  has_gz_ = rests_ = true;
  quality_ = Quality::kGood;
}

// Within a sample the roll goes on: its mean is the phase at its middle and psi'' dt^2 / 24, its
// length falls short by a sinc.
void TurnBlock(bool third, Block& block) {
  const double p = block.rate, q = block.bend, dt = block.period, length = block.seconds;
  const double whole = InverseSinc(p * dt), late = q * dt * dt / 24;
  const Complex to_middle = std::polar(1., block.roll),
                to_U = whole * std::polar(1., block.roll + late);
  const Turned wx = Turn(block.sum[kWx], p, q), wy = Turn(block.sum[kWy], p, q);
  const Turned fx = Turn(block.sum[kFx], p, q), fy = Turn(block.sum[kFy], p, q);
  const Complex i(0, 1);
  block.wx = to_U * wx.zeroth;
  block.wy = to_U * wy.zeroth;
  block.fx = to_U * fx.zeroth;
  block.fy = to_U * fy.zeroth;
  block.w_first = to_U * (wx.first + i * wy.first);
  block.f_first = to_U * (fx.first + i * fy.first);
  // What a constant of T comes to: third order finds its change in U and so its very integral.
  const double spread = (length * length - (third ? 0 : 2 * dt * dt)) / 24;
  block.unit = to_middle * length * Complex(1 - p * p * spread, q * spread);
}

}  // namespace wellgyro::increment
