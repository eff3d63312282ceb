#include "wellgyro/simulate/rate_noise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/simulate/random_stream.h"

namespace wellgyro {
namespace {

// Of a Gauss-Markov process whose Allan deviation peaks at the floor 0.6643 B of flicker noise, to
// 0.1 per cent (1.07600 is exact): hundreds of runs would not show the difference.
constexpr double kSigmaOfB = 1.075;
// Correlation times of the processes that flicker noise is made of: 0.25 s to 0.25 * 4^10 s = 73 h.
constexpr double kFlickerRatio = 4;
constexpr double kFlickerShortest = 0.25;  // [s]
constexpr int kFlickerProcesses = 11;

// Streams of one axis, apart from every other axis' by the caller's stream number.
enum RateStream : std::uint64_t { kWhite, kWalk, kDrawn, kInstability, kStreamsPerAxis = 32 };

// Covariance of (state at the end, integral) of a unit Gauss-Markov process that began at a known
// value, x correlation times ago; times in correlation times.
struct Innovation {
  double end_end, end_sum, sum_sum;
};

Innovation InnovationAfter(double x) {
  const double e = std::exp(-x), d = -std::expm1(-x);
  // Below 0.02 the closed form of the last one cancels: its series.
  const double sum_sum =
      x < 0.02 ? x * x * x * (2.0 / 3 - x * (0.5 - x * 7 / 30)) : 2 * x - 3 + 4 * e - e * e;
  return {.end_end = d * (1 + e), .end_sum = d * d, .sum_sum = sum_sum};
}

}  // namespace

GaussMarkov::GaussMarkov(double sigma, double correlation_time, Random random)
    : sigma_(sigma),
      correlation_time_(correlation_time),
      random_(random),
      value_(sigma * random_.Normal()) {}

double GaussMarkov::Mean(double seconds) {
  const double x = seconds / correlation_time_;
  const Innovation q = InnovationAfter(x);
  const double end = std::sqrt(q.end_end) * random_.Normal();
  const double gain = q.end_sum / q.end_end;
  const double rest = std::sqrt(std::max(q.sum_sum - gain * q.end_sum, 0.0));
  const double sum = gain * end + rest * random_.Normal();
  const double mean = (-std::expm1(-x) * value_ + sigma_ * sum) / x;
  value_ = std::exp(-x) * value_ + sigma_ * end;
  return mean;
}

RateNoise::RateNoise(const NoiseCoefficients& noise, bool flicker, std::uint64_t seed,
                     std::uint64_t stream)
    : noise_(noise),
      white_(RandomStream(seed, stream * kStreamsPerAxis + kWhite)),
      walk_random_(RandomStream(seed, stream * kStreamsPerAxis + kWalk)) {
  Random drawn = RandomStream(seed, stream * kStreamsPerAxis + kDrawn);
  const double constant = drawn.Normal();
  ramp_ = drawn.Uniform() < 0.5 ? -noise.rate_ramp : noise.rate_ramp;
  if (noise.bias_instability == 0) return;
  const auto random = [&](int i) {
    return RandomStream(seed,
                        stream * kStreamsPerAxis + kInstability + static_cast<std::uint64_t>(i));
  };
  if (flicker) {
    const double sigma = noise.bias_instability * std::sqrt(std::log(kFlickerRatio) / kPi);
    for (int i = 0; i < kFlickerProcesses; ++i) {
      instability_.emplace_back(sigma, kFlickerShortest * std::pow(kFlickerRatio, i), random(i));
    }
  } else if (noise.bias_instability_correlation_time) {
    instability_.emplace_back(kSigmaOfB * noise.bias_instability,
                              *noise.bias_instability_correlation_time, random(0));
  } else {
    constant_ = noise.bias_instability * constant;
  }
}

double RateNoise::Mean(double seconds) {
  double mean = constant_ + ramp_ * (time_ + 0.5 * seconds);
  time_ += seconds;
  if (noise_.angle_random_walk != 0) {
    mean += noise_.angle_random_walk / std::sqrt(seconds) * white_.Normal();
  }
  if (noise_.rate_random_walk != 0) {
    // Mean and end of a Wiener process from its begin, jointly.
    const double scale = noise_.rate_random_walk * std::sqrt(seconds);
    const double end = walk_random_.Normal(), rest = walk_random_.Normal();
    mean += walk_ + scale * (0.5 * end + rest / std::sqrt(12.0));
    walk_ += scale * end;
  }
  for (GaussMarkov& process : instability_) mean += process.Mean(seconds);
  return mean;
}

}  // namespace wellgyro
