#include "wellgyro/uncertainty/error_model.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "wellgyro/base/angle.h"
#include "wellgyro/uncertainty/formula_weight.h"
#include "wellgyro/uncertainty/gyro_mode.h"

namespace wellgyro {
namespace {

using Role = WeightRole;

bool Has(const ErrorModel& model, Role role) {
  return std::ranges::any_of(model.terms, [&](const auto& t) { return t.weight->role == role; });
}

bool HasExternal(const ErrorModel& model) {
  return Has(model, Role::kExternal) || Has(model, Role::kExternalAtTie);
}

bool IsInclination(double x) { return x >= 0 && x <= kPi; }

std::string AboutTerm(const ErrorTerm& term) {
  if (!term.weight) return "has no weighting function";
  if ((term.weight == &OwnFormula()) != (term.formula != nullptr)) {
    return "has a formula beside a published weight, or none where it should";
  }
  if (!std::isfinite(term.magnitude) || term.magnitude < 0) {
    return "has a magnitude that is not finite or below 0";
  }
  const Role role = term.weight->role;
  const bool random = term.propagation == Propagation::kRandom;
  if (role == Role::kCourse && !random) return "is a course length error and so must be random";
  if ((role == Role::kDrift || role == Role::kRamp) && random)
    return "is a drift and so cannot be random";
  if ((role == Role::kExternal || role == Role::kExternalAtTie) && random) {
    return "is an azimuth that is carried on and so cannot be random";
  }
  return {};
}

std::string AboutNeeds(const ErrorModel& model, const WeightFunction& w) {
  const auto same_gyro = [&](const ContinuousZone& zone) { return zone.axes == w.axes; };
  switch (w.role) {
    case Role::kStationary:
    case Role::kStationaryNoise:
      if (!model.stationary) return "needs [stationary]";
      if (w.axes != model.stationary->axes) return "is of another gyro than [stationary] names";
      if (w.role == Role::kStationaryNoise && !model.stationary->noise_reduction) {
        return "needs noise_reduction in [stationary]";
      }
      return {};
    case Role::kDrift:
    case Role::kWalk:
    case Role::kRateWalk:
    case Role::kRamp:
      if (std::ranges::none_of(model.continuous, same_gyro)) {
        return "needs a [[continuous]] zone of its gyro";
      }
      return {};
    case Role::kCantedAccel:
      return model.cant ? "" : "needs cant_deg";
    case Role::kShortCourse:
      return model.min_course_length ? "" : "needs min_course_length_m";
    case Role::kCourse:
      return model.tortuosity ? "" : "needs tortuosity_deg_per_100ft";
    default:
      return {};
  }
}

std::string AboutStationary(const StationaryMode& mode, bool continuous) {
  if (!IsInclination(mode.end)) return "[stationary]: end_deg must lie within 0 and 180";
  if (mode.noise_reduction && !(*mode.noise_reduction > 0 && *mode.noise_reduction <= 1)) {
    return "[stationary]: noise_reduction must lie above 0 and not above 1";
  }
  if (mode.min_distance && !(*mode.min_distance >= 0)) {
    return "[stationary]: min_distance_m must not be below 0";
  }
  if (continuous && !mode.initialise) {
    return "[stationary] needs initialise_deg, as the model has continuous gyros";
  }
  if (!continuous) return mode.initialise ? "initialise_deg without a [[continuous]] gyro" : "";
  if (!(*mode.initialise <= kPi)) return "[stationary]: initialise_deg must not exceed 180";
  if (mode.end > 0 && *mode.initialise != mode.end) {
    return "[stationary]: initialise_deg must be end_deg, where the stationary range ends";
  }
  if (mode.end == 0 && *mode.initialise >= 0 && !mode.min_distance) {
    return "[stationary] needs min_distance_m, as the tool only initialises";
  }
  return {};
}

std::string AboutContinuous(const ErrorModel& model) {
  if (model.continuous.size() > kMaxZones) return "more than three [[continuous]] zones";
  double end = 0;
  for (const ContinuousZone& zone : model.continuous) {
    if (!IsInclination(zone.begin) || !IsInclination(zone.end) || zone.end <= zone.begin) {
      return "[[continuous]]: inclinations must increase within 0 and 180 deg";
    }
    if (zone.begin < end) return "[[continuous]]: zones overlap or are out of order";
    if (!(zone.speed > 0) || !std::isfinite(zone.speed)) {
      return "[[continuous]]: the speed must be above 0";
    }
    end = zone.end;
  }
  if (!model.continuous.empty() && !HasExternal(model) && !model.stationary) {
    return "[[continuous]] needs [stationary] or an EXT-REF term: nothing initialises it";
  }
  if (HasExternal(model) && model.stationary) {
    return "EXT terms beside [stationary]: a tool is initialised by one or the other";
  }
  return {};
}

std::string AboutParameters(const ErrorModel& model) {
  if (!(model.max_inclination > 0) || !IsInclination(model.max_inclination)) {
    return "inclination_max_deg must lie above 0 and not above 180";
  }
  if (!(model.vertical_limit > 0) || model.vertical_limit > 0.1) {
    return "vertical_limit_deg must lie above 0 and below 5";
  }
  if (model.cant && !(std::abs(*model.cant) < kPi / 2)) return "cant_deg must be below 90";
  if (model.min_course_length && !(*model.min_course_length > 0)) {
    return "min_course_length_m must be above 0";
  }
  if (model.tortuosity && !(*model.tortuosity > 0)) return "the tortuosity must be above 0";
  return {};
}

}  // namespace

std::optional<ModelComplaint> FindComplaint(const ErrorModel& model) {
  if (model.terms.empty()) return ModelComplaint{"the model has no terms", {}};
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < model.terms.size(); ++i) {
    const ErrorTerm& term = model.terms[i];
    std::string text = AboutTerm(term);
    if (text.empty()) text = AboutNeeds(model, *term.weight);
    if (text.empty() && !names.insert(term.name).second) text = "stands twice";
    if (!text.empty()) return ModelComplaint{"term " + term.name + " " + text, i};
  }
  std::string text = AboutParameters(model);
  if (text.empty()) text = AboutContinuous(model);
  if (text.empty() && model.stationary) {
    text = AboutStationary(*model.stationary, !model.continuous.empty());
  }
  if (text.empty()) return std::nullopt;
  return ModelComplaint{std::move(text), {}};
}

}  // namespace wellgyro
