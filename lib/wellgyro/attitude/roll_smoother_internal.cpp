#include "wellgyro/attitude/roll_smoother_internal.h"

#include <cmath>

namespace wellgyro::increment {
namespace {

// Walks of the roll's rate that are tried [rad/s/sqrt(s)]: from a clamped tool to a drill string.
constexpr std::array<double, 6> kWalks{1e-4, 1e-3, 1e-2, 1e-1, 1, 10};
// A tool told to rest does not roll: half of what the Earth turns it [rad/s].
constexpr double kRestRate = 3.6e-5;

}  // namespace

double RollSmoother::Score::value() const {
  return count * std::log(misfit / count + 1e-300) + log_variance;
}

inline void RollSmoother::Predict(double h, double walk, bool linked, State& s) {
  const double q = walk * walk * h;
  s.roll += h * s.rate;
  s.p00 += h * (2 * s.p01 + h * s.p11) + q * h * h / 3;
  s.p01 += h * s.p11 + 0.5 * q * h;
  s.p11 += q;
  if (!linked) s.p00 = 1e4, s.p01 = 0;
}

inline void RollSmoother::Update(const Block& block, State& s, Score& score) {
  if (block.weight > 0) {
    const double noise = 1 / block.weight, sum = s.p00 + noise, off = block.phase - s.roll;
    if (s.p00 < 1) {  // else nothing was foretold
      score.misfit += off * off / sum;
      score.log_variance += std::log(sum);
      ++score.count;
    }
    const double k0 = s.p00 / sum, k1 = s.p01 / sum;
    s.roll += k0 * off;
    s.rate += k1 * off;
    s.p11 -= k1 * s.p01;
    s.p00 = k0 * noise;
    s.p01 *= noise / sum;
  } else if (block.rests) {
    const double sum = s.p11 + kRestRate * kRestRate, k0 = s.p01 / sum, k1 = s.p11 / sum;
    s.roll -= k0 * s.rate;
    s.rate -= k1 * s.rate;
    s.p00 -= k0 * s.p01;
    s.p01 *= 1 - k1;
    s.p11 *= 1 - k1;
  }
}

RollSmoother::Score RollSmoother::Forward(std::uint64_t begin, std::uint64_t end, double walk,
                                          const Blocks& blocks, bool keep) {
  State s = before_;
  Score score;
  for (std::uint64_t k = begin; k < end; ++k) {
    const Block& block = blocks[k];
    if (k > 0) Predict(blocks[k - 1].middle() + block.middle(), walk, block.linked, s);
    Update(block, s, score);
    if (keep) states_[k - begin] = s;
  }
  return score;
}

// Returns the smoothed value of the block before `begin`, to which this stretch joins.
double RollSmoother::Backward(std::uint64_t begin, std::uint64_t end, std::uint64_t ahead,
                              double walk, Blocks& blocks) const {
  double roll = states_[ahead - 1 - begin].roll, rate = states_[ahead - 1 - begin].rate;
  const std::uint64_t first = begin > 0 ? begin - 1 : 0;
  for (std::uint64_t k = ahead; k-- > first;) {
    const State& s = k < begin ? before_ : states_[k - begin];
    if (k + 1 < ahead) {
      const double h = blocks[k].middle() + blocks[k + 1].middle();
      State next = s;
      Predict(h, walk, blocks[k + 1].linked, next);
      // P F^T (P-)^-1 (smoothed - foretold)
      const double u0 = roll - next.roll, u1 = rate - next.rate;
      double v0 = 0, v1 = u1 / next.p11;
      if (blocks[k + 1].linked) {
        const double det = next.p00 * next.p11 - next.p01 * next.p01;
        v0 = (next.p11 * u0 - next.p01 * u1) / det;
        v1 = (next.p00 * u1 - next.p01 * u0) / det;
      }
      roll = s.roll + (s.p00 + h * s.p01) * v0 + s.p01 * v1;
      rate = s.rate + (s.p01 + h * s.p11) * v0 + s.p11 * v1;
    }
    if (k >= begin && k < end) {
      blocks[k].roll = roll;
      blocks[k].rate = rate;
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
      double step = smoothed - before;
      if (!b.linked)
        step = (a.middle() + b.middle()) * 0.5 * (a.rate + b.rate);
      else if (b.has_gz)
        step = b.phase - a.phase;
      roll_ += step;
    } else {
      roll_ = smoothed;
    }
    b.roll = roll_;
    before = smoothed;
  }
}

void RollSmoother::Smooth(std::uint64_t begin, std::uint64_t end, std::uint64_t ahead,
                          Blocks& blocks) {
  double walk = kWalks[0], least = 0;
  for (std::size_t i = 0; i < kWalks.size(); ++i) {
    const Score score = Forward(begin, ahead, kWalks[i], blocks, false);
    if (i > 0 && !(score.value() < least)) continue;
    walk = kWalks[i];
    least = score.value();
  }
  Forward(begin, ahead, walk, blocks, true);
  Join(begin, end, Backward(begin, end, ahead, walk, blocks), blocks);
  before_ = states_[end - 1 - begin];
}

}  // namespace wellgyro::increment
