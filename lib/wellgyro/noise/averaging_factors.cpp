#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "wellgyro/noise/allan_variance.h"

namespace wellgyro {

std::vector<std::int64_t> OctaveFactors(std::int64_t samples) {
  std::vector<std::int64_t> factors;
  for (std::int64_t m = 1; m <= samples / 2; m *= 2) factors.push_back(m);
  return factors;
}

std::vector<std::int64_t> DecadeFactors(std::int64_t samples) {
  std::vector<std::int64_t> factors;
  for (std::int64_t decade = 1; decade <= samples / 2; decade *= 10) {
    for (std::int64_t k = 1; k < 10 && k * decade <= samples / 2; ++k) {
      factors.push_back(k * decade);
    }
  }
  return factors;
}

std::vector<std::int64_t> FactorsOf(std::span<const double> taus, double period,
                                    std::int64_t samples) {
  if (!(period > 0)) throw std::invalid_argument("FactorsOf: period must be positive");
  std::vector<std::int64_t> factors;
  for (const double tau : taus) {
    if (!(tau > 0)) {
      throw std::invalid_argument("FactorsOf: averaging time must be positive, not " +
                                  std::to_string(tau));
    }
    const double m = std::max(1., std::round(tau / period));
    const std::int64_t longest = samples / 2;
    if (m <= static_cast<double>(longest)) factors.push_back(static_cast<std::int64_t>(m));
  }
  std::sort(factors.begin(), factors.end());
  factors.erase(std::unique(factors.begin(), factors.end()), factors.end());
  return factors;
}

}  // namespace wellgyro
