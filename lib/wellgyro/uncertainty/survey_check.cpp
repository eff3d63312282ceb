#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/uncertainty/formula_weight.h"
#include "wellgyro/uncertainty/survey_check_internal.h"

namespace wellgyro {
namespace {

[[noreturn]] void Throw(const std::string& text) { throw std::invalid_argument(text); }

std::string At(std::size_t k, const SurveyPoint& point) {
  return "station " + std::to_string(k + 1) + ", MD " + std::to_string(point.md) + " m: ";
}

bool NeedsLatitude(const ErrorModel& model) {
  return std::ranges::any_of(model.terms, [](const auto& t) {
    return t.weight->role == WeightRole::kStationary ||
           t.weight->role == WeightRole::kStationaryNoise ||
           (t.formula && t.formula->needs_latitude());
  });
}

bool NeedsMagnetics(const ErrorModel& model) {
  return std::ranges::any_of(model.terms, [](const auto& t) {
    return t.weight->role == WeightRole::kMagnetic || (t.formula && t.formula->needs_field());
  });
}

}  // namespace

void CheckSurvey(std::span<const SurveyPoint> survey) {
  if (survey.size() < 2) Throw("a survey needs at least two stations");
  for (std::size_t k = 0; k < survey.size(); ++k) {
    const SurveyPoint& p = survey[k];
    if (!std::isfinite(p.md) || !std::isfinite(p.inclination) || !std::isfinite(p.azimuth) ||
        !std::isfinite(p.tvd)) {
      Throw(At(k, p) + "a value is not finite");
    }
    if (p.inclination < 0 || p.inclination > kPi) {
      Throw(At(k, p) + "inclination " + std::to_string(ToDegrees(p.inclination)) +
            " deg is not within 0 and 180");
    }
    if (k == 0) continue;
    if (p.md <= survey[k - 1].md) Throw(At(k, p) + "measured depth does not increase");
    const SurveyPoint& before = survey[k - 1];
    if (Tangent(p.inclination, p.azimuth).dot(Tangent(before.inclination, before.azimuth)) <
        -0.999) {
      Throw(At(k, p) + "the hole points back the way it came");
    }
  }
}

void CheckSurroundings(const Surroundings& place) {
  if (place.latitude && !(std::abs(*place.latitude) <= kPi / 2)) {
    Throw("latitude " + std::to_string(ToDegrees(*place.latitude)) + " deg is not within 90");
  }
  if (!(place.gravity > 9.7 && place.gravity < 9.9)) {
    Throw("gravity " + std::to_string(place.gravity) + " m/s2 is not the Earth's");
  }
  if (!(std::abs(place.convergence) <= kPi)) Throw("the convergence is not within 180 deg");
  if (place.field && !(*place.field > 1e-6 && *place.field < 1e-3)) {
    Throw("field " + std::to_string(*place.field * 1e9) + " nT is not the Earth's");
  }
  if (place.dip && !(std::abs(*place.dip) < kPi / 2)) Throw("the dip is not within 90 deg");
  if (place.declination && !(std::abs(*place.declination) <= kPi)) {
    Throw("the declination is not within 180 deg");
  }
}

void CheckLegs(std::span<const ToolLeg> legs, std::size_t stations, const Surroundings& place) {
  std::size_t expected = 0;
  for (const ToolLeg& leg : legs) {
    if (!leg.model) Throw("a tool leg has no error model");
    const std::string name = "model " + leg.model->name;
    if (auto complaint = FindComplaint(*leg.model)) Throw(name + ": " + complaint->text);
    if (leg.begin != expected || leg.end <= leg.begin) {
      Throw("tool legs must follow each other: station " + std::to_string(expected + 1));
    }
    expected = leg.end;
    if (NeedsLatitude(*leg.model) && !place.latitude) {
      Throw(name + " has gyrocompass terms: the latitude is needed");
    }
    if (NeedsLatitude(*leg.model) && std::abs(*place.latitude) > 89 * kPi / 180) {
      Throw(name + ": no gyrocompass works above 89 deg of latitude");
    }
    if (NeedsMagnetics(*leg.model) && !(place.field && place.dip && place.declination)) {
      Throw(name + " has magnetic terms: field, dip and declination are needed");
    }
  }
  if (expected != stations) Throw("tool legs must cover the survey to its last station");
}

}  // namespace wellgyro
