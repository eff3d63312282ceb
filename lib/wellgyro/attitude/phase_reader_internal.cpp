#include "wellgyro/attitude/phase_reader_internal.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"

namespace wellgyro::increment {
namespace {

// Least sin I (0.5 deg) at which gravity measures the roll. The azimuth's own turning is divided by
// sin I: here a whirl of 0.1 deg turns the phase by 0.2 rad, and a correction linear in it fails.
// At 0.25 deg the estimate on the way of a clean well that kicks off at 2 rpm is lost, a stop is 15
// sigmas off it; at 1 deg the ends of three clean runs move by 0.04 sigma.
constexpr double kSineMin = 0.0087;
// Of noise, where none is told: what a double leaves of it in the smoother [m/s^2 sqrt(s)].
constexpr double kNoiseMin = 5e-7;
// A third gyro's integral is followed as it is [rad]: in a block of 0.02 s the slowest walk that is
// tried, q = 1e-3 rad/s/sqrt(s), moves psi by q T^1.5 / sqrt(3) = 1.6e-6.
constexpr double kGyroSigma = 1e-6;
// Rate of the phase, by which the next is unwrapped: mean over a quarter of a second [1/s]. A turn
// is lost only where it errs by pi in a block; at 2 and at 8 three clean runs have the same bytes.
constexpr double kRateGain = 4;

}  // namespace

void PhaseReader::ReadGyro(bool follows, Block& b) {
  const double spin = b.sum[kWz].zeroth;
  b.phase = axial_ + 0.5 * spin;
  b.weight = 1 / (kGyroSigma * kGyroSigma);
  b.linked = follows;
  axial_ += spin;
  seen_ = false;
}

void PhaseReader::ReadGravity(Block& b) {
  const double per = 1 / (b.seconds * options_.gravity);
  const double noise = std::max(options_.accel_noise, kNoiseMin) / options_.gravity;
  const Complex force(b.sum[kFx].zeroth * per, b.sum[kFy].zeroth * per);
  const double s = std::abs(force);
  across_ += started_ ? (s - across_) * std::min(1., b.seconds) : s;
  started_ = true;
  // Four sigma: no slip in the unwrapping. Five of the bias: it turns the phase by 0.2 rad, evenly.
  const double least = std::max(
      {kSineMin, 4 * noise / std::sqrt(b.seconds), 5 * options_.accel_bias / options_.gravity});
  const bool followed = seen_;
  seen_ = std::min(s, across_) >= least;
  if (!seen_) return;
  const Complex to_high = std::conj(force) / s, turn(b.sum[kWx].zeroth, b.sum[kWy].zeroth);
  b.swept = (turn * to_high).real() / s * b.sum[kFz].zeroth * per;
  double phase = std::arg(to_high);
  if (followed) {
    phase += kTwoPi * std::round((phase_ + rate_ * b.seconds - phase) / kTwoPi);
    rate_ += ((phase - phase_) / b.seconds - rate_) * std::min(1., kRateGain * b.seconds);
  }
  b.phase = phase + swept_ + 0.5 * b.swept;
  b.weight = s * s * b.seconds / (noise * noise);
  b.linked = followed;
  swept_ += b.swept;
  phase_ = phase;
}

void PhaseReader::Read(Blocks& blocks) {
  const std::uint64_t k = blocks.end() - 1;
  Block& b = blocks[k];
  b.weight = b.swept = 0;
  b.linked = true;
  const bool gyro = b.has_gz && b.samples > 0;
  if (gyro) {
    ReadGyro(had_gyro_, b);
  } else if (b.samples == 0 || b.accel_full_scale) {
    seen_ = false;
  } else {
    ReadGravity(b);
  }
  had_gyro_ = gyro;
  // Half way is not the mean where the sweeping changes: five adjoining integrals give the mean of
  // their sum over the middle one to the sixth order.
  if (k < blocks.begin() + 4 || gyro) return;
  for (std::uint64_t j = k - 3; j <= k; ++j) {
    if (!(blocks[j].weight > 0 && blocks[j].linked)) return;
  }
  const double inner = blocks[k - 1].swept - blocks[k - 3].swept;
  const double outer = blocks[k].swept - blocks[k - 4].swept;
  blocks[k - 2].phase += (11 * outer - 82 * inner) / 1440;
}

}  // namespace wellgyro::increment
