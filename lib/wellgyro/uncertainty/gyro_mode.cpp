#include "wellgyro/uncertainty/gyro_mode.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

constexpr double kSmallestFactor = 0.01;  // of sin I or cos I: 0.6 deg from where it vanishes

/// Azimuth at which the arc from `a` to `b` first reaches `inclination`, which lies between theirs.
double AzimuthOnArc(const SurveyPoint& a, const SurveyPoint& b, double inclination) {
  const Eigen::Vector3d from = Tangent(a.inclination, a.azimuth);
  const Eigen::Vector3d to = Tangent(b.inclination, b.azimuth);
  const Eigen::Vector3d across = to - from.dot(to) * from;
  if (across.norm() < 1e-12) return b.azimuth;
  const Eigen::Vector3d side = across.normalized();
  // cos(inclination) = from.z cos(x) + side.z sin(x), on its way down.
  const double reach = std::hypot(from.z(), side.z());
  const double wanted = std::cos(inclination);
  const double x = std::atan2(side.z(), from.z()) +
                   std::atan2(std::sqrt(std::max(0.0, reach * reach - wanted * wanted)), wanted);
  const Eigen::Vector3d t = std::cos(x) * from + std::sin(x) * side;
  return WrapTwoPi(std::atan2(t.y(), t.x()));
}

double TurnFactor(GyroAxes axes, double inclination) {
  switch (axes) {
    case GyroAxes::kXy:
      return std::sin(inclination);
    case GyroAxes::kZ:
      return std::cos(inclination);
    case GyroAxes::kXyz:
      break;
  }
  return 1;
}

}  // namespace

GyroModeTracker::GyroModeTracker(const ErrorModel& model) : model_(model) {
  if (!model.stationary || !model.stationary->initialise) return;
  initialise_ = *model.stationary->initialise;
  returns_to_rest_ = model.stationary->end > 0;
}

void GyroModeTracker::Open(double inclination, double azimuth) {
  mode_ = {};
  mode_.section = ++opened_;
  mode_.init_inclination = inclination;
  mode_.init_azimuth = azimuth;
}

const GyroMode& GyroModeTracker::Begin(const SurveyPoint& first) {
  last_initialised_ = first.md;
  if (model_.continuous.empty()) return mode_;
  if (initialise_ < 0) {
    Open(first.inclination, first.azimuth);
  } else if (first.inclination > initialise_) {
    began_above_ = true;
    Open(initialise_, first.azimuth);
  }
  return mode_;
}

const GyroMode& GyroModeTracker::Advance(const SurveyPoint& previous, const SurveyPoint& point) {
  if (model_.continuous.empty()) return mode_;
  if (initialise_ >= 0 && point.inclination <= initialise_) {
    if (returns_to_rest_) {
      mode_ = {};
      return mode_;
    }
    if (mode_.section > 0 && point.md - last_initialised_ > *model_.stationary->min_distance) {
      last_initialised_ = point.md;
      Open(point.inclination, point.azimuth);
      return mode_;
    }
  } else if (mode_.section == 0) {
    const GyroMode before = mode_;
    Open(initialise_, AzimuthOnArc(previous, point, initialise_));
    mode_.drift_time = before.drift_time;
    mode_.walk_time = before.walk_time;
  }
  Gather(previous, point);
  return mode_;
}

void GyroModeTracker::Gather(const SurveyPoint& previous, const SurveyPoint& point) {
  const auto holds = [&](const ContinuousZone& zone) { return point.inclination <= zone.end; };
  const auto zone = std::ranges::find_if(model_.continuous, holds);
  if (zone == model_.continuous.end() || point.inclination < zone->begin) {
    if (mode_.section == 0) return;  // still at rest
    mode_.refusal = "no continuous gyro of the model covers this inclination";
    return;
  }
  const double mean = (previous.inclination + point.inclination) / 2;
  const double factor = TurnFactor(zone->axes, mean);
  if (std::min(factor, TurnFactor(zone->axes, point.inclination)) < kSmallestFactor) {
    mode_.refusal = "the gyro's axis does not feel the turn of the hole at this inclination";
    return;
  }
  const double time = (point.md - previous.md) / zone->speed;
  const auto i = static_cast<std::size_t>(zone - model_.continuous.begin());
  mode_.drift_time[i] += time / factor;
  mode_.walk_time[i] += time / (factor * factor);
}

}  // namespace wellgyro
