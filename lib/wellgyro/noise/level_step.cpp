#include <algorithm>
#include <cmath>
#include <vector>

#include "wellgyro/noise/level_step_internal.h"

namespace wellgyro {
namespace {

// Innovations of the local level model of noise variance 1 and walk variance q a value, from an
// unknown level on.
struct LevelFilter {
  std::vector<double> v, F;   // innovations and their variances, from the second value on
  double log_likelihood = 0;  // with the noise's variance at its likeliest

  LevelFilter(std::span<const double> y, double q) {
    double level = y[0], P = 1 + q, squares = 0, log_F = 0;
    for (std::size_t i = 1; i < y.size(); ++i) {
      v.push_back(y[i] - level);
      F.push_back(P + 1);
      squares += v.back() * v.back() / F.back();
      log_F += std::log(F.back());
      level += P / F.back() * v.back();
      P = P / F.back() + q;
    }
    const auto n = static_cast<double>(v.size());
    variance = squares / n;
    log_likelihood = -(n * std::log(std::max(variance, 1e-300)) + log_F) / 2;
  }
  double variance = 0;
};

LevelFilter Likeliest(std::span<const double> y) {
  LevelFilter best(y, 0);
  for (double q = 1e-8; q < 2; q *= 2) {
    LevelFilter filter(y, q);
    if (filter.log_likelihood > best.log_likelihood) best = std::move(filter);
  }
  return best;
}

// The likeliest step of a filtered series, `margin` values from its ends at least: backward
// recursion of the score r of a step at each place and of its information N.
LevelStep LikeliestStep(const LevelFilter& filter, std::size_t margin) {
  LevelStep best;
  double r = 0, N = 0, most = 0;
  for (std::size_t i = filter.v.size(); i-- > 0;) {
    const double L = 1 / filter.F[i];
    r = filter.v[i] / filter.F[i] + L * r;
    N = 1 / filter.F[i] + L * L * N;
    const std::size_t at = i + 1;
    if (at < margin || at + margin > filter.v.size()) continue;
    if (r * r / N <= most) continue;
    most = r * r / N;
    best = {at, r / N};
  }
  return best;
}

}  // namespace

std::optional<LevelStep> FindLevelStep(std::span<const double> values) {
  // Means on either side of a step, which tell their level to 1 / sqrt(20) = 22 % of a mean's
  // sigma; and ten times as many to tell white noise from a walk by.
  constexpr std::size_t kMargin = 20, kLeast = 200;
  if (values.size() < kLeast) return std::nullopt;
  const LevelFilter without = Likeliest(values);
  if (!(without.variance > 0)) return std::nullopt;
  // A walk that the step itself asked for hides it: the best one without a walk is tried as well.
  std::optional<LevelStep> best;
  for (const LevelFilter& filter : {without, LevelFilter(values, 0)}) {
    LevelStep step = LikeliestStep(filter, kMargin);
    std::vector<double> rest(values.begin(), values.end());
    for (std::size_t i = step.at; i < rest.size(); ++i) rest[i] -= step.size;
    step.evidence = 2 * (Likeliest(rest).log_likelihood - without.log_likelihood);
    if (!best || step.evidence > best->evidence) best = step;
  }
  return best;
}

}  // namespace wellgyro
