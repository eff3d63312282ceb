#include <cmath>
#include <stdexcept>
#include <string>

#include "wellgyro/attitude/tracker.h"

namespace wellgyro {
namespace {

void CheckPositive(const char* name, double value) {
  if (value > 0 && std::isfinite(value)) return;
  throw std::invalid_argument(std::string("TrackerOptions.") + name + " must be positive, is " +
                              std::to_string(value));
}

void CheckNotNegative(const char* name, double value) {
  if (value >= 0 && std::isfinite(value)) return;
  throw std::invalid_argument(std::string("TrackerOptions.") + name + " must not be negative, is " +
                              std::to_string(value));
}

}  // namespace

HighSideTracker::HighSideTracker(const TrackerOptions& options)
    : options_(options), roll_(options.toolface_seconds) {
  CheckNotNegative("accel_noise", options.accel_noise);
  CheckNotNegative("angle_random_walk", options.angle_random_walk);
  CheckPositive("level_seconds", options.level_seconds);
  CheckPositive("acceleration_doubt", options.acceleration_doubt);
  CheckPositive("inclination_min", options.inclination_min);
  CheckPositive("sigma_toolface_max", options.sigma_toolface_max);
  CheckPositive("roll_limit", options.roll_limit);
  CheckPositive("toolface_seconds", options.toolface_seconds);
  CheckPositive("roll_rate_seconds", options.roll_rate_seconds);
  CheckNotNegative("unseen.dogleg", options.unseen.dogleg);
  CheckNotNegative("unseen.rate", options.unseen.rate);
  CheckPositive("unseen.seconds", options.unseen.seconds);
  if (!options.p_accel_T.allFinite()) {
    throw std::invalid_argument("TrackerOptions.p_accel_T is not finite");
  }
  off_axis_ = !options.p_accel_T.head<2>().isZero(0);
}

}  // namespace wellgyro
