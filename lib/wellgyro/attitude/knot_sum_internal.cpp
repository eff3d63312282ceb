#include "wellgyro/attitude/knot_sum_internal.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "wellgyro/attitude/roll_following_internal.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/math/plane.h"
#include "wellgyro/math/square.h"

namespace wellgyro::increment {
namespace {

constexpr Complex kI(0, 1);

double Axial(Complex a, Complex b) { return a.real() * b.imag() - a.imag() * b.real(); }

// What the block's neighbours say of it.
struct Across {
  Complex slope = 0;  // change of the turn's rate [rad/s^2]
  double unkept = 0;  // of the turn, for want of samples within a period of whirl and roll [rad]
  double roll_missed = 0;  // of the block's mean psi by a third axis, between its samples [rad]
};

// Mean rates tell psi at the ends of a block, not where in it the rate changed. Of one that steps
// by p anywhere within five blocks of length T the mean psi of each is off by up to 0.075 T
// sqrt(D3^2 + (D4/3)^2), D3 and D4 the third and fourth differences of the rates, of the order of p
// (enumerated in the test); of smooth ones by less.
double RollMissed(double seconds, double third, double fourth) {
  constexpr double kMissed = 0.075;
  return kMissed * seconds * std::hypot(third, fourth / 3);
}

// Slope of the turn's rate from the integrals of neighbouring blocks: five points, exact for a
// quartic, or three or two at an end. Truncation error of the turn, D4 the fourth difference and T
// the block's length: unkept = kUnkept T |D4 turn| |D4 rate|. Whirl and roll that oscillate as one
// have a mean turn, of which samples miss a share ~ (w dt)^4 for each of the two, and fourth
// differences grow alike. kUnkept is measured: 3 Hz sampled at 10 Hz, where half is missed.
Across LookAcross(std::uint64_t k, const Blocks& blocks) {
  constexpr double kUnkept = 1e-3;
  const Block& block = blocks[k];
  const bool before = k > blocks.begin() && Adjoin(blocks[k - 1], block);
  const bool after = k + 1 < blocks.end() && Adjoin(block, blocks[k + 1]);
  const double per = 1 / (block.seconds * block.seconds);
  if (!before && !after) return {};
  if (!before || !after) {
    const std::uint64_t a = before ? k - 1 : k;
    return {per * (blocks[a + 1].turn() - blocks[a].turn())};
  }
  const Block &b1 = blocks[k - 1], &a1 = blocks[k + 1];
  const Complex inner = a1.turn() - b1.turn();
  if (k - 1 == blocks.begin() || !Adjoin(blocks[k - 2], b1) || k + 2 == blocks.end() ||
      !Adjoin(a1, blocks[k + 2])) {
    return {per * 0.5 * inner};
  }
  const Block &b2 = blocks[k - 2], &a2 = blocks[k + 2];
  const Complex bend = a2.turn() + b2.turn() - 4. * (a1.turn() + b1.turn()) + 6. * block.turn();
  const double swing = a2.rate + b2.rate - 4 * (a1.rate + b1.rate) + 6 * block.rate;
  const double third = a2.rate - b2.rate - 2 * (a1.rate - b1.rate);
  return {per * (34. * inner - 5. * (a2.turn() - b2.turn())) / 48.,  // of means, for a quartic
          kUnkept * block.seconds * std::abs(bend) * std::abs(swing),
          block.has_gz ? RollMissed(block.seconds, third, swing) : 0};
}

// A block made ready to be summed in parts: integrals and first moments about its middle.
struct Ready {
  const Block& b;
  Complex turn, turn_first, force, force_first;
  double unkept, roll_missed;
};
Ready MakeReady(std::uint64_t k, bool third, const Blocks& blocks) {
  const Block& b = blocks[k];
  Ready r{b, b.turn(), b.w_first, b.force(), b.f_first, 0, 0};
  if (b.samples == 0) {
    r.turn = k > blocks.begin() ? b.carried * b.seconds : 0;
    return r;
  }
  const double within = b.period * b.period * b.seconds / 12;
  const Across across = LookAcross(k, blocks);
  r.turn_first += within * across.slope;
  const Complex leaning = within * kI * (b.turn() / b.seconds) * (b.sum[kFz].zeroth / b.seconds);
  r.force_first += leaning;
  r.unkept = across.unkept;
  r.roll_missed = across.roll_missed;
  const Complex missing = kI * b.rate * within * across.slope;
  if (third) {
    r.turn += missing;
    r.force += kI * b.rate * leaning;
  } else {
    r.unkept += std::abs(missing);
  }
  return r;
}

// Of something with integral `whole` and first moment `first` about the middle of a length: the
// integral and first moment of a part [from, to] of it, were it straight.
struct Part {
  double share, share_first, first_share, first_first;
  Part(double length, double from, double to) {
    const double d1 = to - from, d2 = 0.5 * (to * to - from * from);
    const double d3 = (to * to * to - from * from * from) / 3,
                 lean = 12 / (length * length * length);
    share = d1 / length;
    share_first = lean * d2;
    first_share = d2 / length;
    first_first = lean * d3;
  }
  Complex Of(Complex whole, Complex first) const { return share * whole + share_first * first; }
  Complex FirstOf(Complex whole, Complex first) const {
    return first_share * whole + first_first * first;
  }
};

// Share of an oscillation that the smoother of the phase passes, at once and twice the roll rate:
// the Wiener filter 1 / (1 + R nu^4 / q^2) of a phase whose rate is a random walk q, of density
// q^2 / nu^4, in white noise of density R.
Eigen::Vector2d WobbleFollowed(const Block& b) {
  if (!(b.walk > 0)) return Eigen::Vector2d::Zero();
  const double square = b.rate * b.rate;
  const double missed = b.seconds / b.weight * square * square / (b.walk * b.walk);
  return {1 / (1 + missed), 1 / (1 + 16 * missed)};
}

// Integrals over the parts of a knot's blocks in it, x + i y across the axis, de-rolled by psi
// where the block's integrals are. Those of force leave out blocks at full scale; `forced` is their
// time.
struct Sums {
  Complex turn = 0;            // of the rate [rad]
  double unkept = 0;           // bound of the truncation error of `turn` [rad]
  double coning = 0;           // axial turn of second order, half the integral of turn x w [rad^2]
  Complex wx = 0, wy = 0;      // of either gyro's rate, turned by psi [rad]
  Complex unit = 0;            // of exp(i psi) [s]
  Complex skew = 0;            // of the rate of psi times the rate [rad^2/s]
  Complex fx = 0, fy = 0;      // of either accelerometer's force, turned by psi [m/s]
  Complex unit_z = 0;          // of f_z exp(i psi) [m/s]
  Complex back = 0;            // of the force, in the attitude at the knot's begin [m/s]
  double back_z = 0;           // its part along the axis [m/s]
  Complex turn_moment = 0;     // first moment of the rate about the knot's begin [rad s]
  Complex force_moment = 0;    // first moment of the force about it [m]
  double x = 0, y = 0, z = 0;  // of the force in T [m/s]
  double forced = 0;           // time with force [s]
  double followed = 0;         // of the root of Block::walk [s sqrt(rad/s/sqrt(s))]
  double blocks = 0;           // number of blocks, by their shares [1]
  double var_missed = 0;       // variance of the integral of psi by a third axis [rad^2 s^2]
  Eigen::Vector2d wobble = Eigen::Vector2d::Zero();  // of WobbleFollowed [s]
  std::array<Complex, 4> harmonics{};                // as Increment::turn_by_harmonic [rad]
  Complex force() const { return fx + kI * fy; }

  void Add(const Ready& r, double from, double to, double at);
};

// `at`: the block's middle from the knot's begin [s].
void Sums::Add(const Ready& r, double from, double to, double at) {
  const Block& b = r.b;
  const Part part(b.seconds, from, to);
  const Complex w = part.Of(r.turn, r.turn_first), w1 = part.FirstOf(r.turn, r.turn_first);
  const double length = to - from, centre = 0.5 * (from + to);
  const Complex w1_here = w1 - centre * w;  // about the part's own middle
  const Complex theta = turn + 0.5 * w - w1_here / length;
  coning += 0.5 * Axial(turn, w) + Axial(w, w1_here) / length;
  turn += w;
  unkept += part.share * r.unkept;
  turn_moment += at * w + w1;
  if (b.samples == 0) return;
  const Complex spin = kI * b.rate * b.seconds * b.seconds / 12.;
  const auto turning = [&](Complex whole) { return part.Of(whole, spin * whole); };
  wx += turning(b.wx);
  wy += turning(b.wy);
  unit += turning(b.unit);
  skew += b.rate * w + b.bend * w1;
  const Complex ahead = b.unit / b.seconds, back_turned = std::conj(ahead) * w;
  const std::array turned{back_turned, ahead * w, std::conj(ahead) * back_turned,
                          ahead * ahead * w};
  for (std::size_t i = 0; i < turned.size(); ++i) harmonics[i] += turned[i];
  if (b.accel_full_scale) return;
  wobble += length * WobbleFollowed(b);
  followed += length * std::sqrt(b.walk);
  blocks += part.share;
  var_missed += Square(length * r.roll_missed);
  const Complex f = part.Of(r.force, r.force_first), f1 = part.FirstOf(r.force, r.force_first);
  fx += part.share * b.fx;
  fy += part.share * b.fy;
  const auto mean = [&](Channel of) {
    return part.share * b.sum[of].zeroth + part.share_first * b.sum[of].first;
  };
  const double fz = mean(kFz);
  const double fz1 =
      part.first_share * b.sum[kFz].zeroth + part.first_first * b.sum[kFz].first - centre * fz;
  const Complex rate = w / length, f1_here = f1 - centre * f;
  back += f - kI * (theta * fz + rate * fz1);
  back_z += fz + Axial(theta, f) + Axial(rate, f1_here);
  x += mean(kFx);
  y += mean(kFy);
  z += fz;
  unit_z += turning(b.unit) * (b.sum[kFz].zeroth / b.seconds);
  force_moment += at * f + f1;
  forced += length;
}

double Seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

void FillErrors(const Sums& s, Complex to_M, Complex edge, Increment& out) {
  const auto turn = [&](ErrorSource source, Complex z) {
    out.turn_by_error.col(source) = VectorOf(to_M * z);
  };
  turn(kGyroBiasX, s.unit);
  turn(kGyroBiasY, kI * s.unit);
  turn(kMassUnbalance, s.force());
  turn(kQuadrature, -kI * s.force());
  turn(kGyroScaleX, s.wx);
  turn(kGyroScaleY, kI * s.wy);
  out.turn_by_error.col(kMisalignmentX) = VectorOf(-kI * edge);
  out.turn_by_error.col(kMisalignmentY) = VectorOf(edge);
  turn(kToolfaceOffset, kI * s.turn);
  turn(kTimeSkew, kI * s.skew);
  if (!(s.forced > 0)) return;
  const auto force = [&](ErrorSource source, Complex z) {
    out.ForceBy(source).head<2>() = VectorOf(to_M * z / s.forced);
  };
  force(kAccelBiasX, s.unit);
  force(kAccelBiasY, kI * s.unit);
  out.ForceBy(kAccelBiasZ).z() = 1;
  force(kAccelScaleX, s.fx);
  force(kAccelScaleY, kI * s.fy);
  out.ForceBy(kAccelScaleZ).z() = s.z / s.forced;
  force(kAccelMisalignmentX, s.unit_z);
  force(kAccelMisalignmentY, kI * s.unit_z);
  force(kAccelShear, s.fy + kI * s.fx);
  out.ForceBy(kAccelMisalignmentZX).z() = s.x / s.forced;
  out.ForceBy(kAccelMisalignmentZY).z() = s.y / s.forced;
}

// Harmonics are of psi, not from the middle on.
void FillWobble(const Sums& s, Complex to_M, Increment& out) {
  out.wobble_followed = s.wobble / out.seconds;
  const std::array by{Complex(1), to_M * to_M, std::conj(to_M), to_M * to_M * to_M};
  for (std::size_t i = 0; i < by.size(); ++i) {
    out.turn_by_harmonic.col(static_cast<Eigen::Index>(i)) = VectorOf(by[i] * s.harmonics[i]);
  }
}

void FillFlags(const Block& b, double seconds, Increment& out) {
  out.quality |= b.quality;
  if (!b.has_gz || b.samples == 0) out.has_axial = false;
  if (b.lost > 0) out.quality |= Quality::kGap;
  if (b.samples == 0) {
    out.gap_seconds += seconds;
    out.roll_seen = false;
    out.quality |= Quality::kGap;
    return;
  }
  if (b.gyro_full_scale) out.gap_seconds += seconds;
  if (!(b.weight > 0) && !b.has_gz) out.roll_seen = false;
}

void FillSamples(const KnotSpan& span, const Blocks& blocks, Increment& out) {
  bool first = true;
  for (std::uint64_t k = span.begin_block; k <= span.end_block; ++k) {
    const Block& b = blocks[k];
    if (b.samples == 0) continue;
    const std::int64_t period = b.length_ns / b.samples;
    const std::int64_t from = std::max<std::int64_t>(0, span.begin_ns - b.begin_ns) / period;
    const std::int64_t to = (std::min(span.end_ns, b.end_ns()) - b.begin_ns + period - 1) / period;
    if (to <= from) continue;
    if (first) out.seq_begin = b.seq_begin + from;
    if (from == 0) out.samples_lost += b.lost;
    out.seq_end = b.seq_begin + to;
    first = false;
  }
}

// psi at an instant of block k, by a cubic from the blocks' middles; by a third axis by a parabola
// that ends where its integral does.
double RollAt(std::int64_t ns, std::uint64_t k, const Blocks& blocks) {
  const double t = Seconds(ns - blocks[k].begin_ns) - blocks[k].middle();
  const bool back = t < 0;
  const bool alone =
      back ? k == blocks.begin() || blocks[k].anew : k + 1 == blocks.end() || blocks[k + 1].anew;
  if (alone || blocks[k].has_gz)
    return blocks[k].roll + t * (blocks[k].rate + 0.5 * t * blocks[k].bend);
  const Block& a = blocks[back ? k - 1 : k];
  const Block& b = blocks[back ? k : k + 1];
  const double h = a.middle() + b.middle(), u = (back ? t + h : t) / h, v = 1 - u;
  return v * v * (1 + 2 * u) * a.roll + u * u * (1 + 2 * v) * b.roll +
         u * v * h * (v * a.rate - u * b.rate);
}

// What stands at the knot's middle, from its begin.
struct Middle {
  Complex turn = 0;
  double coning = 0, roll = 0;
};

Sums SumBlocks(const KnotSpan& span, bool third, const Blocks& blocks, Middle& middle,
               Increment& out) {
  const double half = 0.5 * out.seconds;
  bool halved = false;
  Sums s;
  for (std::uint64_t k = span.begin_block; k <= span.end_block; ++k) {
    const Ready r = MakeReady(k, third, blocks);
    const double begin = Seconds(r.b.begin_ns - span.begin_ns), at = begin + r.b.middle();
    double from = std::max(begin, 0.);
    const double to = std::min(begin + r.b.seconds, out.seconds);
    if (to <= from) continue;
    FillFlags(r.b, to - from, out);
    // In the first block that reaches it: where it stands between two, both may just miss it.
    if (!halved && half <= to) {
      if (from < half) s.Add(r, from - at, half - at, at);
      middle = {s.turn, s.coning,
                RollAt(span.begin_ns + (span.end_ns - span.begin_ns) / 2, k, blocks)};
      from = std::max(from, half);
      halved = true;
    }
    if (to > from) s.Add(r, from - at, to - at, at);
  }
  return s;
}

// Forces were turned back to the knot's begin: from there to its middle.
void FillForce(const Sums& s, const Middle& middle, double accel_noise, Complex to_M,
               Increment& out) {
  out.level = 2 * s.forced >= out.seconds;
  out.sigma_roll = kTwoPi;
  if (!(s.forced > 0)) return;
  const Complex f = (s.back + kI * middle.turn * s.z) / s.forced;
  const double fz = (s.back_z - Axial(middle.turn, s.force())) / s.forced;
  out.force_M << VectorOf(to_M * f), fz;
  out.force_per_roll =
      VectorOf(to_M * kI * (s.force_moment / out.seconds - 0.5 * s.force()) / s.forced);
  // Of the slope of a line through phases of white noise.
  if (!(std::abs(f) * kTwoPi > std::sqrt(12 / s.forced) * accel_noise)) return;
  const double density = accel_noise / std::abs(f);  // of the phase, root of R
  out.sigma_roll = std::sqrt(12 / s.forced) * density;
  if (!(density > 0)) return;
  out.lateral = LateralVariance(s.followed / std::sqrt(density), s.blocks);
  // A hundredth of the variance costs half a per cent of a sigma, as good as nothing.
  constexpr double kNothing = 0.01;
  const double missed = s.var_missed / (s.forced * density * density);
  if (missed > kNothing) out.lateral += missed;
}

}  // namespace

Increment SumKnot(const KnotSpan& span, bool third, double accel_noise, const Blocks& blocks) {
  Increment out;
  out.seconds = Seconds(span.end_ns - span.begin_ns);
  out.roll_seen = out.has_axial = true;
  Middle middle;
  const Sums s = SumBlocks(span, third, blocks, middle, out);
  const Complex to_M = std::polar(1., -middle.roll);
  const double before = middle.roll - RollAt(span.begin_ns, span.begin_block, blocks);
  const double after = RollAt(span.end_ns, span.end_block, blocks) - middle.roll;
  out.roll_before = before + middle.coning;
  out.roll_after = after + s.coning - middle.coning;
  out.turn_M = VectorOf(to_M * s.turn);
  out.turn_before_M = VectorOf(to_M * middle.turn);
  out.turn_per_roll = VectorOf(to_M * kI * (s.turn_moment / out.seconds - 0.5 * s.turn));
  out.var_turn = s.unkept * s.unkept;
  FillForce(s, middle, accel_noise, to_M, out);
  FillErrors(s, to_M, std::polar(1., after) - std::polar(1., -before), out);
  FillWobble(s, to_M, out);
  FillSamples(span, blocks, out);
  return out;
}

}  // namespace wellgyro::increment
