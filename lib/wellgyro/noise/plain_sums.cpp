#include <algorithm>
#include <cmath>

#include "wellgyro/noise/term_sums_internal.h"

namespace wellgyro {
namespace {

// A sum that keeps what rounding takes from it.
class CarriedSum {
 public:
  void Add(double x) {
    const double sum = high_ + x;
    const double virtual_part = sum - high_;
    low_ += (high_ - (sum - virtual_part)) + (x - virtual_part);
    high_ = sum;
  }
  double value() const { return high_ + low_; }

 private:
  double high_ = 0;
  double low_ = 0;
};

std::vector<double> Bridged(const BridgedRates& rates) {
  std::vector<double> y(rates.rate.begin(), rates.rate.end());
  for (const auto& bridge : rates.bridges) {
    std::fill(y.begin() + bridge.gap.begin, y.begin() + bridge.gap.end, bridge.value);
  }
  return y;
}

double SumOf(std::span<const double> y, double shift) {
  double sum = 0;
  for (const double value : y) sum += value - shift;
  return sum;
}

// In blocks, so that the rounding of long sums stays that of short ones, n eps / 2 = 1.1e-13 of the
// sum of sizes.
double WindowSum(std::span<const double> y, double shift) {
  constexpr std::size_t kShortSum = 1024;
  if (y.size() <= kShortSum) return SumOf(y, shift);
  CarriedSum sum;
  for (std::size_t i = 0; i < y.size(); i += kShortSum) {
    sum.Add(SumOf(y.subspan(i, std::min(kShortSum, y.size() - i)), shift));
  }
  return sum.value();
}

bool SumSideBySide(std::span<const double> y, double shift, TermSum& sum) {
  const auto m = static_cast<std::size_t>(sum.factor);
  CarriedSum squares;
  std::size_t range = 0;
  double last = 0;
  for (std::size_t at = 0; at + m <= y.size(); at += m) {
    const double now = WindowSum(y.subspan(at, m), shift);
    if (!(std::abs(now) <= kBeyondAnySum)) return false;
    const auto k = static_cast<std::int64_t>(at) - sum.factor;
    while (range < sum.usable.size() && sum.usable[range].end <= k) ++range;
    if (k >= 0 && range < sum.usable.size() && sum.usable[range].begin <= k) {
      squares.Add((now - last) * (now - last));
      ++sum.terms;
    }
    last = now;
  }
  sum.squares = squares.value();
  return true;
}

// Phases from the carried sum: each is off by its own rounding only.
std::vector<double> PhasesOf(std::span<const double> y, double shift) {
  std::vector<double> x(y.size() + 1);
  CarriedSum sum;
  for (std::size_t i = 0; i < y.size(); ++i) {
    sum.Add(y[i] - shift);
    x[i + 1] = sum.value();
  }
  return x;
}

void SumModified(std::span<const double> x, TermSum& sum) {
  const auto m = static_cast<std::size_t>(sum.factor);
  const auto difference = [&](std::size_t k) {
    return (x[k + 2 * m] - x[k + m]) - (x[k + m] - x[k]);
  };
  CarriedSum squares;
  for (const auto& range : sum.usable) {
    const auto begin = static_cast<std::size_t>(range.begin);
    const auto end = static_cast<std::size_t>(range.end);
    CarriedSum window;
    for (std::size_t k = begin; k < begin + m; ++k) window.Add(difference(k));
    for (std::size_t k = begin; k < end; ++k) {
      if (k > begin) {
        window.Add(difference(k + m - 1));
        window.Add(-difference(k - 1));
      }
      squares.Add(window.value() * window.value());
    }
    sum.terms += range.end - range.begin;
  }
  sum.squares = squares.value();
}

void Report(const BridgedRates& rates, std::size_t done, std::size_t all) {
  if (rates.progress) rates.progress(static_cast<double>(done) / static_cast<double>(all));
}

}  // namespace

bool SumSideBySide(const BridgedRates& rates, std::span<TermSum> sums) {
  const std::vector<double> y = Bridged(rates);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (!SumSideBySide(y, rates.shift, sums[i])) return false;
    Report(rates, i + 1, sums.size());
  }
  return true;
}

bool SumModified(const BridgedRates& rates, std::span<TermSum> sums) {
  const std::vector<double> x = PhasesOf(Bridged(rates), rates.shift);
  if (!(std::abs(x.back()) <= kBeyondAnySum)) return false;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    SumModified(x, sums[i]);
    Report(rates, i + 1, sums.size());
  }
  return true;
}

}  // namespace wellgyro
