#include "wellgyro/bus/latency.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace wellgyro {
namespace {

// ln 1.1: a percentile is the upper end of its class, at most 10 % too long; 280 classes from 1 us
// on reach 1.1^280 us = 4.5 days.
constexpr double kClass = 0.0953101798;

}  // namespace

void Latency::Add(std::int64_t us) {
  const double classes = std::log(static_cast<double>(std::max<std::int64_t>(us, 1))) / kClass;
  const std::size_t i = std::min(static_cast<std::size_t>(classes), counts_.size() - 1);
  ++counts_[i];
  ++recent_[i];
}

std::int64_t Latency::Recent(bool reset) {
  const std::int64_t p99 = Of(recent_, 0.99);
  if (reset) recent_ = {};
  return p99;
}

std::int64_t Latency::Of(const Counts& counts, double share) {
  std::int64_t all = 0, below = 0;
  for (const std::int64_t count : counts) all += count;
  if (all == 0) return 0;
  std::size_t i = 0;
  for (; i + 1 < counts.size(); ++i) {
    below += counts[i];
    if (static_cast<double>(below) >= share * static_cast<double>(all)) break;
  }
  return static_cast<std::int64_t>(std::exp(static_cast<double>(i + 1) * kClass));
}

}  // namespace wellgyro
