#include "wellgyro/attitude/roll_smoother_internal.h"

#include <algorithm>
#include <cmath>

namespace wellgyro::increment {
namespace {

// A tool told to rest does not roll: half of what the Earth turns it [rad/s].
constexpr double kRestRate = 3.6e-5;
// Variance of the phase over what the noise told makes of it: beyond it what moves is the tool. A
// phase followed too closely costs less than one that is not followed: 1e-7 rad of turn. At 1 and
// at 4 the ends of three clean runs move by 0.001 sigma.
constexpr double kLevelMost = 2;

}  // namespace

inline void RollSmoother::Predict(const Seen& seen, double walk, State& s) {
  const double h = seen.step, q = walk * walk * h;
  s.roll += h * s.rate;
  s.p00 += h * (2 * s.p01 + h * s.p11) + q * h * h * (1. / 3);
  s.p01 += h * s.p11 + 0.5 * q * h;
  s.p11 += q;
  if (!seen.linked) s.p00 = 1e4, s.p01 = 0;
}

inline void RollSmoother::Update(const Seen& seen, State& s) {
  if (seen.measured) {
    const double per = 1 / (s.p00 + seen.noise), off = seen.phase - s.roll;
    const double k0 = s.p00 * per, k1 = s.p01 * per, left = seen.noise * per;
    s.roll += k0 * off;
    s.rate += k1 * off;
    s.p11 -= k1 * s.p01;
    s.p00 *= left;
    s.p01 *= left;
  } else if (seen.rests) {
    const double per = 1 / (s.p11 + kRestRate * kRestRate), k0 = s.p01 * per, k1 = s.p11 * per;
    s.roll -= k0 * s.rate;
    s.rate -= k1 * s.rate;
    s.p00 -= k0 * s.p01;
    s.p01 *= 1 - k1;
    s.p11 *= 1 - k1;
  }
}

// Every walk by its own filter, once over every block.
void RollSmoother::Try(std::uint64_t end, const Blocks& blocks) {
  for (std::uint64_t k = seen_.end(); k < end; ++k) {
    const Block& b = blocks[k];
    Seen seen{0, b.phase, 0, b.weight > 0, b.linked, b.rests};
    if (k > 0) seen.step = blocks[k - 1].middle() + b.middle();
    if (seen.measured) seen.noise = 1 / b.weight;
    seen_.Push(seen);
    for (std::size_t i = 0; i < kWalks.size(); ++i) {
      State& s = tried_[i];
      Score& score = now_[i];
      if (k > 0) Predict(seen, kWalks[i], s);
      if (seen.measured && s.p00 < 1) {  // else nothing was foretold
        const double sum = s.p00 + seen.noise, off = seen.phase - s.roll;
        score.misfit += off * off / sum;
        score.product *= sum;
        if (++score.count % 8 == 0) {  // far from what a double can hold
          score.log_variance += std::log(score.product);
          score.product = 1;
        }
      }
      Update(seen, s);
    }
  }
}

// By this stretch and what is seen beyond it, which is the next one.
double RollSmoother::ChooseWalk() {
  double walk = kWalks[0], least = 0;
  for (std::size_t i = 0; i < kWalks.size(); ++i) {
    Score& a = last_[i];
    Score& b = now_[i];
    const int count = a.count + b.count;
    double value = 0;
    if (count > 0) {
      const double misfit = a.misfit + b.misfit;
      const double level = std::clamp(misfit / count, 1e-300, kLevelMost);
      value = count * std::log(level) + misfit / level + a.log_variance + b.log_variance +
              std::log(a.product) + std::log(b.product);
    }
    a = b;
    b = Score();
    if (i > 0 && !(value < least)) continue;
    walk = kWalks[i];
    least = value;
  }
  return walk;
}

// Returns the smoothed value of the block before `begin`, to which this stretch joins.
double RollSmoother::Backward(std::uint64_t begin, std::uint64_t end, std::uint64_t ahead,
                              double walk, Blocks& blocks) const {
  double roll = states_[ahead - 1 - begin].roll, rate = states_[ahead - 1 - begin].rate;
  const std::uint64_t first = begin > 0 ? begin - 1 : 0;
  for (std::uint64_t k = ahead; k-- > first;) {
    const State& s = k < begin ? before_ : states_[k - begin];
    if (k + 1 < ahead) {
      const Seen& seen = seen_[k + 1];
      State next = s;
      Predict(seen, walk, next);
      // P F^T (P-)^-1 (smoothed - foretold)
      const double u0 = roll - next.roll, u1 = rate - next.rate;
      double v0 = 0, v1 = u1 / next.p11;
      if (seen.linked) {
        const double per = 1 / (next.p00 * next.p11 - next.p01 * next.p01);
        v0 = (next.p11 * u0 - next.p01 * u1) * per;
        v1 = (next.p00 * u1 - next.p01 * u0) * per;
      }
      roll = s.roll + (s.p00 + seen.step * s.p01) * v0 + s.p01 * v1;
      rate = s.rate + (s.p01 + seen.step * s.p11) * v0 + s.p11 * v1;
    }
    if (k >= begin && k < end) {
      blocks[k].roll = roll;
      blocks[k].rate = rate;
      blocks[k].walk = blocks[k].has_gz || !seen_[k].measured ? 0 : walk;
    }
  }
  return roll;
}

// One roll from stretch to stretch, and across places where the phase begins anew: there its rate
// goes on. A third gyro is followed to the letter.
void RollSmoother::Join(std::uint64_t begin, std::uint64_t end, double before, Blocks& blocks) {
  for (std::uint64_t k = begin; k < end; ++k) {
    Block& b = blocks[k];
    const double smoothed = b.roll;
    if (b.has_gz) b.rate = b.sum[kWz].zeroth / b.seconds;
    if (k > 0) {
      const Block& a = blocks[k - 1];
      if (!b.linked) {
        roll_ += (a.middle() + b.middle()) * 0.5 * (a.rate + b.rate);
      } else {
        roll_ += b.has_gz ? b.phase - a.phase : smoothed - before;
      }
    } else {
      roll_ = smoothed;
    }
    b.roll = roll_;
    before = smoothed;
  }
}

void RollSmoother::Smooth(std::uint64_t begin, std::uint64_t end, std::uint64_t ahead,
                          Blocks& blocks) {
  Try(ahead, blocks);
  const double walk = ChooseWalk();
  State s = before_;
  for (std::uint64_t k = begin; k < ahead; ++k) {
    if (k > 0) Predict(seen_[k], walk, s);
    Update(seen_[k], s);
    states_[k - begin] = s;
  }
  Join(begin, end, Backward(begin, end, ahead, walk, blocks), blocks);
  before_ = states_[end - 1 - begin];
  seen_.DropBefore(end);
}

}  // namespace wellgyro::increment
