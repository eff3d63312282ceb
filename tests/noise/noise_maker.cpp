#include "noise/noise_maker.h"

#include <cmath>
#include <numbers>

namespace wellgyro::test {
namespace {

using Complex = std::complex<double>;

// Fourier sum of a sequence that stands in bit-reversed order, in place; n a power of two.
void TransformBitReversed(Complex* x, std::size_t n, const Complex* roots, std::size_t stride) {
  if (n == 1) return;
  const std::size_t half = n / 2;
  TransformBitReversed(x, half, roots, 2 * stride);
  TransformBitReversed(x + half, half, roots, 2 * stride);
  for (std::size_t k = 0; k < half; ++k) {
    const Complex w = roots[k * stride];
    const Complex odd{w.real() * x[half + k].real() - w.imag() * x[half + k].imag(),
                      w.real() * x[half + k].imag() + w.imag() * x[half + k].real()};
    x[half + k] = x[k] - odd;
    x[k] += odd;
  }
}

}  // namespace

std::pair<std::vector<double>, std::vector<double>> FlickerPair(std::size_t samples, double b,
                                                                Random& random) {
  std::size_t n = 2;
  while (n < 2 * samples) n *= 2;
  static std::vector<Complex> roots;
  if (roots.size() != n / 2) {
    roots.resize(n / 2);
    for (std::size_t k = 0; k < n / 2; ++k) {
      roots[k] =
          std::polar(1., 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
    }
  }
  std::vector<Complex> x(n);
  std::size_t reversed = 0;
  for (std::size_t k = 1; k < n; ++k) {
    std::size_t bit = n / 2;
    for (; (reversed & bit) != 0; bit /= 2) reversed ^= bit;
    reversed |= bit;
    // |sin(pi k/n)| from the roots: cos is their real part at half the angle.
    const std::size_t fold = k <= n / 2 ? k : n - k;
    const double sine = fold == n / 2 ? 1 : std::sqrt((1 - roots[fold].real()) / 2);
    const double exact =
        fold < 4096
            ? std::sin(std::numbers::pi * static_cast<double>(fold) / static_cast<double>(n))
            : sine;
    const double a = b / std::sqrt(2 * exact * static_cast<double>(n));
    x[reversed] = {a * random.Normal(), a * random.Normal()};
  }
  TransformBitReversed(x.data(), n, roots.data(), 1);
  std::pair<std::vector<double>, std::vector<double>> logs;
  logs.first.resize(samples);
  logs.second.resize(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    logs.first[i] = x[i].real();
    logs.second[i] = x[i].imag();
  }
  return logs;
}

std::pair<std::vector<double>, std::vector<double>> LogPair(std::size_t samples, double period,
                                                            const NoiseCoefficients& truth,
                                                            std::uint64_t seed) {
  Random random(seed);
  std::pair<std::vector<double>, std::vector<double>> logs;
  if (truth.bias_instability > 0) {
    logs = FlickerPair(samples, truth.bias_instability, random);
  } else {
    logs.first.assign(samples, 0);
    logs.second.assign(samples, 0);
  }
  for (auto* log : {&logs.first, &logs.second}) {
    double walk = 0;
    double edge = random.Uniform() - 0.5;  // quantisation error of the angle, in steps
    for (std::size_t i = 0; i < samples; ++i) {
      double y = truth.angle_random_walk / std::sqrt(period) * random.Normal();
      if (truth.rate_random_walk > 0) {
        // Mean of the walk over the period: half its step, and the bridge between its ends.
        const double step = truth.rate_random_walk * std::sqrt(period) * random.Normal();
        y += walk + step / 2 + truth.rate_random_walk * std::sqrt(period / 12) * random.Normal();
        walk += step;
      }
      if (truth.quantization > 0) {
        const double next = random.Uniform() - 0.5;
        y += truth.quantization * std::sqrt(12.) * (next - edge) / period;
        edge = next;
      }
      y += truth.rate_ramp * (static_cast<double>(i) + 0.5) * period;
      (*log)[i] += y;
    }
  }
  return logs;
}

}  // namespace wellgyro::test
