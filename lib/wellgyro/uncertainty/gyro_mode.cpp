#include "wellgyro/uncertainty/gyro_mode.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/angle.h"
#include "wellgyro/uncertainty/hole_arc_internal.h"

namespace wellgyro {
namespace {

/// Azimuth at which the arc from `a` to `b` reaches `inclination`, which lies between theirs.
double AzimuthOnArc(const SurveyPoint& a, const SurveyPoint& b, double inclination) {
  const HoleArc arc(a, b);
  std::vector<double> places;
  arc.Crossings(inclination, places);
  if (places.empty()) return a.inclination < inclination ? b.azimuth : a.azimuth;
  const Eigen::Vector3d t = arc.Tangent(places.back());
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

void GyroModeTracker::Begin(const SurveyPoint& first) {
  last_initialised_ = first.md;
  if (model_.continuous.empty()) return;
  if (initialise_ < 0) {
    Open(first.inclination, first.azimuth);
  } else if (first.inclination > initialise_) {
    began_above_ = true;
    Open(initialise_, first.azimuth);
  }
}

void GyroModeTracker::Advance(const SurveyPoint& previous, const SurveyPoint& point) {
  if (model_.continuous.empty()) return;
  if (initialise_ >= 0 && point.inclination <= initialise_) {
    if (returns_to_rest_) {
      mode_ = {};
      return;
    }
    if (mode_.section > 0 && point.md - last_initialised_ > *model_.stationary->min_distance) {
      last_initialised_ = point.md;
      Open(point.inclination, point.azimuth);
      return;
    }
  } else if (mode_.section == 0) {
    const GyroMode before = mode_;
    Open(initialise_, AzimuthOnArc(previous, point, initialise_));
    mode_.drift_time = before.drift_time;
    mode_.walk_time = before.walk_time;
    mode_.rate_walk_time = before.rate_walk_time;
    mode_.ramp_time = before.ramp_time;
  }
  Gather(previous, point);
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
  // A sine changes by no more than its angle: most stations need no second one.
  const bool clear = factor - std::abs(point.inclination - mean) > kSmallestTurnFactor;
  if (!clear && std::min(factor, TurnFactor(zone->axes, point.inclination)) < kSmallestTurnFactor) {
    mode_.refusal = "the gyro's axis does not feel the turn of the hole at this inclination";
    return;
  }
  const double time = (point.md - previous.md) / zone->speed;
  const auto i = static_cast<std::size_t>(zone - model_.continuous.begin());
  mode_.drift_time[i] += time / factor;
  mode_.walk_time[i] += time / (factor * factor);
  mode_.rate_walk_time[i] += time * time * time / (3 * factor * factor);
  mode_.ramp_time[i] += time * time / (2 * factor);
}

}  // namespace wellgyro
