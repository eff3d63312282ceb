#include "wellgyro/noise/allan_variance.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "wellgyro/noise/gap_terms_internal.h"
#include "wellgyro/noise/term_sums_internal.h"

namespace wellgyro {
namespace {

void CheckArguments(double period, std::span<const std::int64_t> factors,
                    const AllanOptions& options, std::span<const SampleGap> gaps) {
  if (!(period > 0) || std::isinf(period)) {
    throw std::invalid_argument("AllanVariance: period must be positive, not " +
                                std::to_string(period));
  }
  for (const auto m : factors) {
    if (m < 1) {
      throw std::invalid_argument("AllanVariance: factor must be at least 1, not " +
                                  std::to_string(m));
    }
  }
  if (!(options.max_missing >= 0 && options.max_missing <= 1)) {
    throw std::invalid_argument("AllanVariance: max_missing must be in [0, 1]");
  }
  for (std::size_t g = 0; g < gaps.size(); ++g) {
    if (gaps[g].begin < (g > 0 ? gaps[g - 1].end : 0) || gaps[g].end < gaps[g].begin) {
      throw std::invalid_argument("AllanVariance: gap " + std::to_string(g) + " is out of order");
    }
  }
}

std::vector<SampleGap> Inside(std::span<const SampleGap> gaps, std::int64_t samples) {
  std::vector<SampleGap> inside;
  for (auto gap : gaps) {
    gap.end = std::min(gap.end, samples);
    if (gap.begin < gap.end) inside.push_back(gap);
  }
  return inside;
}

std::int64_t Missing(std::span<const SampleGap> gaps) {
  std::int64_t missing = 0;
  for (const auto& gap : gaps) missing += gap.end - gap.begin;
  return missing;
}

// Differences do not depend on it; sums of rates taken off a present one stay small.
double FirstPresent(std::span<const double> rate, std::span<const SampleGap> gaps) {
  std::int64_t at = 0;
  for (const auto& gap : gaps) {
    if (gap.begin > at) break;
    at = gap.end;
  }
  return at < static_cast<std::int64_t>(rate.size()) ? rate[static_cast<std::size_t>(at)] : 0;
}

std::int64_t Window(Deviation deviation, std::int64_t m) {
  return deviation == Deviation::kModified ? 3 * m - 1 : 2 * m;
}

// The sums at each factor; false when the rates turn out not to be finite somewhere.
bool Sum(std::span<const double> rate, std::span<const SampleGap> gaps, const AllanOptions& options,
         std::span<TermSum> sums) {
  const auto samples = static_cast<std::int64_t>(rate.size());
  for (auto& sum : sums) {
    const std::int64_t m = sum.factor;
    sum = TermSum{};
    sum.factor = m;
    if (m > samples) continue;  // and a huge one must not overflow
    const std::int64_t window = Window(options.deviation, m);
    const double allowed = options.max_missing * static_cast<double>(window);
    sum.usable = UsableTerms(samples, window, static_cast<std::int64_t>(allowed), gaps);
  }
  const std::vector<Bridge> bridges = BridgesOver(rate, gaps);
  const BridgedRates rates{rate, FirstPresent(rate, gaps), bridges, options.progress};
  switch (options.deviation) {
    case Deviation::kAllan:
      return SumSideBySide(rates, sums);
    case Deviation::kModified:
      return SumModified(rates, sums);
    case Deviation::kOverlapped:
      break;
  }
  return SumOverlapped(rates, sums);
}

double VarianceOf(const TermSum& sum, Deviation deviation) {
  if (sum.terms == 0) return 0;
  const auto m = static_cast<double>(sum.factor);
  const double scale = deviation == Deviation::kModified ? m * m : m;
  return sum.squares / scale / scale / (2 * static_cast<double>(sum.terms));
}

}  // namespace

AllanResult AllanVariance(std::span<const double> rate, double period,
                          std::span<const std::int64_t> factors, const AllanOptions& options,
                          std::span<const SampleGap> gaps) {
  CheckArguments(period, factors, options, gaps);
  AllanResult result;
  result.deviation = options.deviation;
  result.period = period;
  result.samples = static_cast<std::int64_t>(rate.size());
  std::vector<TermSum> sums(factors.size());
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i].factor = factors[i];
  std::vector<SampleGap> missing = Inside(gaps, result.samples);
  // Whether all is finite shows in the sums themselves, so good data are read only once.
  bool finite = false;
  if (missing.empty()) finite = Sum(rate, missing, options, sums);
  if (!finite) {
    result.not_finite = NotFinite(rate);
    missing = Union(missing, result.not_finite);
    Sum(rate, missing, options, sums);
  }
  result.missing = Missing(missing);
  for (const auto& sum : sums) {
    result.points.push_back({sum.factor, static_cast<double>(sum.factor) * period, sum.terms,
                             VarianceOf(sum, options.deviation)});
  }
  return result;
}

}  // namespace wellgyro
