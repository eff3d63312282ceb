#include <algorithm>
#include <cmath>
#include <optional>

#include "wellgyro/base/angle.h"
#include "wellgyro/uncertainty/formula_weight.h"
#include "wellgyro/uncertainty/leg_weights_internal.h"

namespace wellgyro {
namespace {

constexpr double kNearSingular = 0.017452406437283512 * (1 - 1e-9);  // sin 1 deg, itself allowed
constexpr double kRounding = 1e-12;  // [rad], of degrees read from files: 180 deg eps = 7e-16

bool IsStationary(WeightRole role) {
  return role == WeightRole::kStationary || role == WeightRole::kStationaryNoise;
}

std::string Degrees(double angle) {
  std::string text = std::to_string(ToDegrees(angle));
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text + " deg";
}

}  // namespace

LegWeights::LegWeights(const ErrorModel& model, const Surroundings& surroundings)
    : model_(model),
      convergence_(surroundings.convergence),
      tracker_(model),
      carried_(model.terms.size()) {
  for (const ErrorTerm& term : model.terms) {
    const auto same_gyro = [&](const ContinuousZone& z) { return z.axes == term.weight->axes; };
    const auto zone = std::ranges::find_if(model.continuous, same_gyro);
    zones_.push_back(static_cast<std::size_t>(zone - model.continuous.begin()));
  }
}

std::string LegWeights::WhyNot(const SurveyPoint& point) const {
  if (point.inclination > model_.max_inclination + kRounding) {
    return "above the greatest inclination of model " + model_.name + ", " +
           Degrees(model_.max_inclination);
  }
  if (!mode().refusal.empty()) return "model " + model_.name + ": " + mode().refusal;
  if (model_.stationary && model_.continuous.empty() &&
      point.inclination > model_.stationary->end + kRounding) {
    return "above the end of the stationary range of model " + model_.name + ", " +
           Degrees(model_.stationary->end);
  }
  return {};
}

/// Azimuth error of the fix that opened the section, per unit of the magnitude.
double LegWeights::CarriedAzimuth(std::size_t term, const WeightPlace& place) {
  Carried& carried = carried_[term];
  if (carried.section == mode().section) return carried.azimuth;
  WeightPlace fix = place;
  const double azimuth = mode().init_azimuth + convergence_;
  fix.inclination = mode().init_inclination;
  fix.sin_inc = std::sin(fix.inclination);
  fix.cos_inc = std::cos(fix.inclination);
  fix.sin_azi = std::sin(azimuth);
  fix.cos_azi = std::cos(azimuth);
  const WeightFunction& weight = *model_.terms[term].weight;
  carried = {mode().section, weight.at(fix).azimuth};
  if (weight.role == WeightRole::kStationaryNoise) {
    carried.azimuth *= model_.stationary->noise_reduction.value_or(1);
  }
  return carried.azimuth;
}

double LegWeights::InitCosine() {
  if (cosine_section_ != mode().section) {
    cosine_section_ = mode().section;
    init_cosine_ = std::cos(mode().init_inclination);
  }
  return init_cosine_;
}

std::optional<Weights> LegWeights::Weigh(std::size_t term, const WeightPlace& place,
                                         std::string& why) {
  const WeightFunction& weight = *model_.terms[term].weight;
  if (const auto& formula = model_.terms[term].formula) {
    const Weights w = formula->At(place.named);
    if (std::isfinite(w.md) && std::isfinite(w.inclination) && std::isfinite(w.azimuth)) return w;
    why = "the formula of term " + model_.terms[term].name + " of model " + model_.name +
          " has no value here";
    return std::nullopt;
  }
  if (weight.role == WeightRole::kDrift) return Weights{0, 0, mode().drift_time[zones_[term]]};
  if (weight.role == WeightRole::kWalk) {
    return Weights{0, 0, std::sqrt(mode().walk_time[zones_[term]])};
  }
  if (weight.role == WeightRole::kRateWalk) {
    return Weights{0, 0, std::sqrt(mode().rate_walk_time[zones_[term]])};
  }
  if (weight.role == WeightRole::kRamp) return Weights{0, 0, mode().ramp_time[zones_[term]]};
  const bool carried = mode().section > 0 && IsStationary(weight.role);
  if (weight.denominator) {
    const double denominator = carried ? InitCosine() : weight.denominator(place);
    if (std::abs(denominator) < kNearSingular) {
      why = "term " + model_.terms[term].name + " of model " + model_.name +
            " is within 1 deg of where it grows beyond all bounds";
      return std::nullopt;
    }
  }
  if (carried) return Weights{0, 0, CarriedAzimuth(term, place)};
  Weights w = weight.at(place);
  if (weight.role == WeightRole::kStationaryNoise &&
      model_.stationary->noise_reduction_at_stations) {
    w.azimuth *= model_.stationary->noise_reduction.value_or(1);
  }
  return w;
}

std::optional<Eigen::Vector3d> LegWeights::Displacement(std::size_t term, const WeightPlace& place,
                                                        bool vertical) const {
  const ErrorTerm& of = model_.terms[term];
  if (of.formula) {
    if (!vertical || !of.formula->has_vector()) return std::nullopt;
    return of.formula->VectorAt(place.named);
  }
  const bool serves = vertical || of.weight->role == WeightRole::kCourse;
  if (!of.weight->vector || !serves) return std::nullopt;
  return of.weight->vector(place);
}

std::int64_t LegWeights::Group(std::size_t term, std::size_t station) const {
  const WeightRole role = model_.terms[term].weight->role;
  if (role == WeightRole::kWalk || role == WeightRole::kRateWalk) return mode().section;
  if (model_.terms[term].propagation != Propagation::kRandom) return 0;
  if (IsStationary(role) && mode().section > 0) return mode().section;
  return -1 - static_cast<std::int64_t>(station);
}

}  // namespace wellgyro
