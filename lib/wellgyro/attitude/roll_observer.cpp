#include "wellgyro/attitude/roll_observer.h"

#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"

namespace wellgyro {

void RollObserver::Take(double spin, double dt, bool trusted, double& cosine, double& sine) {
  if (samples_ == 0) {
    drift_ = 0;
    spin_ = spin;
  }
  const double turned = spin + drift_ * dt;
  // Of the mean, with how much faster it turns at the end than at the begin.
  const double to_mean = turned / 2 - (spin - spin_) / 12;
  if (samples_ == 0) toolface_ = std::atan2(sine, cosine) - to_mean;
  const double mean = toolface_ + to_mean;
  dt_ = dt;
  samples_ += 1;
  double off = 0;
  if (trusted) {
    const double part = dt / seconds_, left = std::exp(-part);
    const double c = std::cos(mean), s = std::sin(mean);
    const double found = std::atan2(sine * c - cosine * s, cosine * c + sine * s);
    off = std::max(1 / samples_, 1 - left * (1 - part)) * found;
    drift_ += left * part * part * found / dt;
  }
  cosine = std::cos(mean + off);
  sine = std::sin(mean + off);
  toolface_ = WrapPi(toolface_ + turned + off);
  spin_ = spin;
}

double RollObserver::Variance(double noise) const {
  return noise * noise * std::max(1.25 / seconds_, 1 / (std::max(samples_, 1.0) * dt_));
}

}  // namespace wellgyro
