#include "wellgyro/attitude/roll_walk_internal.h"

#include <algorithm>
#include <cmath>

namespace wellgyro::vertical {
namespace {

// Before anything is known of how the tool rolls, and again so long after [s].
constexpr PerWalk kFirstWeights = {0.01, 0.01, 0.03, 0.15, 0.8};
constexpr double kForget = 600;
constexpr double kForgetUnseen = 120;  // where nothing is seen: what stops the samples may stop it
constexpr double kLeastWeight = 1e-4;
constexpr double kPatience = 3;  // that long without weight, then start again from the best [s]

}  // namespace

void RollWalk::Reset() {
  weight_ = kFirstWeights;
  idle_.fill(0);
}

void RollWalk::Weigh(const PerWalk& likelihood, double seconds) {
  const double best = *std::max_element(likelihood.begin(), likelihood.end());
  double sum = 0;
  for (std::size_t i = 0; i < kWalks.size(); ++i) {
    weight_[i] *= std::exp(likelihood[i] - best);
    sum += weight_[i];
  }
  for (std::size_t i = 0; i < kWalks.size(); ++i) {
    const bool without = weight_[i] <= kLeastWeight * sum;
    weight_[i] = std::max(weight_[i] / sum, kLeastWeight);
    idle_[i] = without ? idle_[i] + seconds : 0;
  }
  Forget(seconds / kForget);
}

void RollWalk::Pass(double seconds) { Forget(std::min(1.0, seconds / kForgetUnseen)); }

void RollWalk::Forget(double part) {
  for (std::size_t i = 0; i < kWalks.size(); ++i) {
    weight_[i] += (kFirstWeights[i] - weight_[i]) * part;
  }
}

bool RollWalk::TakeIdle(std::size_t i) {
  if (!(idle_[i] > kPatience)) return false;
  idle_[i] = 0;
  return true;
}

double RollWalk::mean() const {
  double sum = 0, mean = 0;
  for (std::size_t i = 0; i < kWalks.size(); ++i) {
    sum += weight_[i];
    mean += weight_[i] * std::log(kWalks[i]);
  }
  return std::exp(mean / sum);
}

double RollWalk::Over(double seconds) const {
  RollWalk then = *this;
  then.Pass(seconds);
  double sum = 0, mean = 0;
  for (std::size_t i = 0; i < kWalks.size(); ++i) {
    sum += then.weight_[i];
    mean += then.weight_[i] * kWalks[i] * kWalks[i];
  }
  return std::sqrt(mean / sum);
}

}  // namespace wellgyro::vertical
