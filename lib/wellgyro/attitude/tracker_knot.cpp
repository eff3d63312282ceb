#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "wellgyro/attitude/tracker.h"

namespace wellgyro {

void HighSideTracker::Errors::Add(const Errors& other, double sign) {
  turn += sign * other.turn;
  lift += sign * other.lift;
  white += sign * other.white;
  jitter += sign * other.jitter;
}

// Over a block all angles stand at their means: it turns by 0.2 rad at most, or is one sample.
HighSideTracker::Block HighSideTracker::Means(const Sums& sums) const {
  Block b;
  b.seconds = sums[kSeconds];
  b.cot = sums[kCot] / b.seconds;
  b.csc = std::sqrt(1 + b.cot * b.cot);
  b.cs = sums[kUnitC] / b.seconds;
  b.sn = sums[kUnitS] / b.seconds;
  b.vh = sums[kLiftH];
  b.vr = sums[kLift];
  b.roll = sums[kRoll];
  b.trust = sums[kTrust] / b.seconds;
  // w_z dt = T' + A' cos I + e_t, with A' from the gyros; of the Earth cos L cos A / sin I is left.
  b.spin =
      has_gz_ ? sums[kSpin] : b.roll - b.cot * b.vh + earth_cos_ * cos_azimuth_ * b.csc * b.seconds;
  return b;
}

// What each error adds to V_h and to V_r.
void HighSideTracker::AddedTo(const Block& b, Knot::SourceVector& across,
                              Knot::SourceVector& rise) const {
  const double sine = 1 / b.csc, per_force = b.csc * inverse_gravity_;
  const double angle_x = b.vh * b.cs + b.vr * b.sn, angle_y = b.vr * b.cs - b.vh * b.sn;
  const auto by_x = [&](Knot::Source source, double angle) {
    across(source) = angle * b.cs;
    rise(source) = angle * b.sn;
  };
  const auto by_y = [&](Knot::Source source, double angle) {
    across(source) = -angle * b.sn;
    rise(source) = angle * b.cs;
  };
  // A toolface too large by d turns V by d.
  const auto by_toolface = [&](Knot::Source source, double toolface) {
    across(source) = -b.vr * toolface;
    rise(source) = b.vh * toolface;
  };
  by_x(Knot::kGyroBiasX, b.seconds);
  by_y(Knot::kGyroBiasY, b.seconds);
  across(Knot::kMassUnbalance) = gravity_ * sine * b.seconds;
  rise(Knot::kQuadrature) = -gravity_ * sine * b.seconds;
  by_x(Knot::kGyroScaleX, angle_x);
  by_y(Knot::kGyroScaleY, angle_y);
  by_x(Knot::kMisalignmentX, b.spin);
  by_y(Knot::kMisalignmentY, b.spin);
  by_toolface(Knot::kToolfaceOffset, 1);
  by_toolface(Knot::kTimeSkew, b.roll / b.seconds);
  by_toolface(Knot::kAccelBiasX, -b.sn * per_force);
  by_toolface(Knot::kAccelBiasY, -b.cs * per_force);
}

HighSideTracker::Errors HighSideTracker::Evaluate(const Sums& sums, const AlongHole& along,
                                                  Observed& observed) const {
  Errors errors;
  if (sums[kSeconds] <= 0) return errors;
  const Block b = Means(sums);
  Knot::SourceVector across = Knot::SourceVector::Zero();
  AddedTo(b, across, errors.lift);

  // Through the observer, as the inclination goes.
  Knot::SourceVector level = Knot::SourceVector::Zero();
  level(Knot::kAccelBiasX) = b.cot / b.csc * inverse_gravity_ * b.cs;
  level(Knot::kAccelBiasY) = -b.cot / b.csc * inverse_gravity_ * b.sn;
  level(Knot::kAccelBiasZ) = inverse_gravity_ / b.csc;
  const Gains gains = Weighed(Steady(b.seconds), b.seconds, b.trust, block_memory_);
  const Knot::SourceVector climb = errors.lift + b.seconds * observed.rate;
  const Knot::SourceVector middle = observed.level + 0.5 * climb;
  const Knot::SourceVector off = level - middle;
  observed.level += climb + gains.level * off;
  observed.rate += gains.rate / b.seconds * off;
  const double noise = options_.accel_noise * inverse_gravity_;
  observed.noise.Take({.seconds = b.seconds,
                       .level = gains.level,
                       .rate = gains.rate,
                       .trust = b.trust,
                       .quiet = Quiet(along),
                       .reach = Reach(block_memory_, b.seconds),
                       .span = block_memory_.span,
                       .per_force = inverse_gravity_ / b.csc,
                       .psd_accel = noise * noise,
                       .psd_gyro = options_.angle_random_walk * options_.angle_random_walk},
                      along);

  errors.turn = -b.csc * across + b.vh * b.csc * b.cot * middle;
  errors.white = b.csc * b.csc * b.seconds;
  // By toolface, and by inclination, whose noise the observer only makes slow: over times long
  // against it their integrals are as large as if it were white.
  const double by_roll = b.vr * b.csc * b.csc, by_inclination = b.vh * b.csc * b.cot;
  errors.jitter = (by_roll * by_roll + by_inclination * by_inclination) / b.seconds;
  return errors;
}

void HighSideTracker::CloseBlock(const AlongHole& along) {
  errors_.Add(Evaluate(block_, along, observed_), 1);
  errors_.Add(given_, -1);
  given_ = {};
  for (int i = 0; i < kSums; ++i) sums_[i] += block_[i];
  block_ = {};
}

// `block` is the open block up to the cut; the observer's own errors stay where the block began.
void HighSideTracker::FillErrors(const Sums& block, Knot& knot) {
  Observed observed = observed_;
  const Errors here = Evaluate(block, last().along, observed);
  errors_.Add(here, 1);
  errors_.Add(given_, -1);
  knot.d_turn = errors_.turn;
  knot.d_lift = errors_.lift;
  knot.d_inclination = observed.level;
  knot.sigma_inclination = std::sqrt(observed.noise.variance());
  knot.white_turn = errors_.white;
  const double noise = options_.accel_noise * inverse_gravity_;
  knot.toolface_noise_turn = noise * noise * errors_.jitter;
  errors_ = {};
  given_ = here;
}

void HighSideTracker::FillStamps(const Seen& s, Duration into, Knot& knot) const {
  knot.time = s.stamp.tool_time + into;
  knot.utc = s.stamp.utc + into;
  knot.along = s.along;
  if (s.along.known) {
    const double t = into.seconds() - 0.5 * s.dt;
    knot.along.md += t * (s.along.speed + 0.5 * t * s.along.acceleration);
    knot.along.speed += t * s.along.acceleration;
  }
  knot.gap_seconds = 1e-9 * static_cast<double>(gap_ns_);
  knot.unseen = unseen_here_;
  knot.var_unseen = var_unseen_;
  knot.level = level_;
  knot.vertical = !empty_ && all_vertical_;
  knot.seq_begin = empty_ ? s.stamp.seq + 1 : seq_begin_;
  knot.seq_end = s.stamp.seq + 1;
  knot.samples_lost = lost_;
  knot.quality = quality_;
}

void HighSideTracker::OpenInterval(const Seen& s, double fraction, std::int64_t rest_ns) {
  cut_ = fraction;
  empty_ = fraction >= 1;
  ns_ = rest_ns;
  gap_ns_ = lost_ = 0;
  unseen_here_ = var_unseen_ = unseen_roll_ = 0;
  level_ = empty_ || !s.stamp.accel_saturated;
  seq_begin_ = s.stamp.seq;
  along_begin_ = s.along;
  all_vertical_ = empty_ || sample_vertical_;
  quality_ = empty_ ? Quality::kGood : sample_quality_;
}

Knot HighSideTracker::CutKnot(double fraction) {
  if (!ready_) throw std::invalid_argument("CutKnot before the first sample has been summed");
  if (!(fraction > 0 && fraction <= 1 && fraction >= cut_)) {
    throw std::invalid_argument("CutKnot: fraction must lie in (0, 1] and not before " +
                                std::to_string(cut_) + ", is " + std::to_string(fraction));
  }
  const Seen& s = last();
  const double rest = 1 - fraction, u = fraction - 0.5;
  const double roll_left = c1_ * (0.5 - u) + c2_ * (0.25 - u * u);
  const std::int64_t rest_ns = std::llround(rest * s.stamp.period_ns);
  Sums block;
  for (int i = 0; i < kSums; ++i) block[i] = block_[i] - rest * part_[i];
  block[kRoll] = block_[kRoll] - roll_left;
  Sums sums;
  for (int i = 0; i < kSums; ++i) sums[i] = sums_[i] + block[i];

  Knot knot;
  FillStamps(s, Duration{s.stamp.period_ns - rest_ns}, knot);
  knot.seconds = 1e-9 * static_cast<double>(ns_ - rest_ns);
  knot.inclination = inclination_ - rest * rise_;
  knot.toolface = WrapPi(toolface() - roll_left);
  knot.turn = -sums[kTurn];
  knot.cot = sums[kCot];
  knot.lift = sums[kLift];
  knot.roll = sums[kRoll] + unseen_roll_;
  FillErrors(block, knot);

  const double noise = options_.accel_noise * inverse_gravity_;
  const double sampled = knot.seconds - knot.gap_seconds;
  knot.inclination_accel = sampled > 0 ? sums[kAccel] / sampled : knot.inclination;
  const double seconds = std::max(sampled, s.dt);
  const double sine = std::sin(knot.inclination) * inverse_gravity_;
  const double by_depth = LevelNoise::MeanVariance(along_begin_, s.along, seconds) * sine * sine;
  knot.sigma_inclination_accel = std::sqrt(noise * noise / seconds + by_depth);

  // The end of a sample, from its own phase and its neighbours' as they are weighed in Across(); of
  // the last before a break from that before it alone.
  const double weighed = waiting_ ? 5. / 6 : 5. / 2;
  const double across = noise / std::max(std::sin(knot.inclination), sin_min_);
  knot.var_toolface = weighed * across * across / s.dt;
  if (s.has_gz) knot.var_toolface = std::min(knot.var_toolface, roll_.Variance(across));

  for (int i = 0; i < kSums; ++i) sums_[i] = -block[i];
  OpenInterval(s, fraction, rest_ns);
  return knot;
}

}  // namespace wellgyro
