#include <algorithm>
#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/uncertainty/station_places_internal.h"

namespace wellgyro {
namespace {

WeightPlace PlaceIn(const Surroundings& surroundings, const SurveyPoint& first) {
  WeightPlace p;
  p.sin_convergence = std::sin(surroundings.convergence);
  p.cos_convergence = std::cos(surroundings.convergence);
  p.cos_latitude = std::cos(surroundings.latitude.value_or(0));
  p.tan_latitude = std::tan(surroundings.latitude.value_or(0));
  p.horizontal_earth_rate = kEarthRate * p.cos_latitude;
  p.gravity = surroundings.gravity;
  if (surroundings.field && surroundings.dip) {
    p.horizontal_field = *surroundings.field * std::cos(*surroundings.dip);
    p.tan_dip = std::tan(*surroundings.dip);
  }
  p.tie_sin_inc = std::sin(first.inclination);
  return p;
}

}  // namespace

std::vector<SurveyPoint> WithoutVerticalAzimuths(std::span<const SurveyPoint> survey,
                                                 std::span<const ToolLeg> legs, int& changed) {
  std::vector<SurveyPoint> points(survey.begin(), survey.end());
  for (const ToolLeg& leg : legs) {
    for (std::size_t k = leg.begin; k < leg.end; ++k) {
      if (points[k].inclination >= leg.model->vertical_limit) continue;
      if (points[k].azimuth != 0) ++changed;
      points[k].azimuth = 0;
    }
  }
  return points;
}

StationPlaces::Angles StationPlaces::AnglesOf(const SurveyPoint& p) {
  return {std::sin(p.inclination), std::cos(p.inclination), std::sin(p.azimuth),
          std::cos(p.azimuth)};
}

StationPlaces::StationPlaces(std::span<const SurveyPoint> survey, const Surroundings& surroundings)
    : survey_(survey),
      surroundings_(surroundings),
      place_(PlaceIn(surroundings, survey.front())),
      ahead_(AnglesOf(survey.front())) {
  const double to_magnetic = surroundings.convergence - surroundings.declination.value_or(0);
  magnetic_sin_ = std::sin(to_magnetic);
  magnetic_cos_ = std::cos(to_magnetic);
}

/// What formulas speak of: first what holds in the whole well.
void StationPlaces::NameValues() {
  place_.named = named_;
  using N = FormulaName;
  const auto put = [&](N name, double value) { named_[static_cast<std::size_t>(name)] = value; };
  const double latitude = surroundings_.latitude.value_or(0);
  for (const N name : {N::kGfield, N::kGtot}) put(name, surroundings_.gravity);
  for (const N name : {N::kBField, N::kMtot}) put(name, surroundings_.field.value_or(0));
  for (const N name : {N::kLatitude, N::kLat}) put(name, latitude);
  put(N::kDip, surroundings_.dip.value_or(0));
  put(N::kRotation, kEarthRate);
  put(N::kErot, kEarthRate * 3600 * std::cos(latitude));
  put(N::kRad, kPi / 180);
  put(N::kMtf, 1);
}

void StationPlaces::StartLeg(const ErrorModel& model) {
  model_ = &model;
  place_.cant = model.cant.value_or(0);
  place_.min_course_length = model.min_course_length.value_or(0);
  place_.tortuosity = model.tortuosity.value_or(0);
}

void StationPlaces::MoveTo(std::size_t k) {
  const SurveyPoint& point = survey_[k];
  const SurveyPoint& previous = survey_[k > 0 ? k - 1 : 0];
  const bool from_vertical = previous.inclination < model_->vertical_limit;
  WeightPlace& p = place_;
  p.md = point.md;
  p.tvd = point.tvd;
  p.course = point.md - previous.md;
  p.inclination = point.inclination;
  p.previous_inclination = previous.inclination;
  p.azimuth_change = from_vertical ? 0 : point.azimuth - previous.azimuth;
  p.sin_inc = ahead_.sin_inc;
  p.cos_inc = ahead_.cos_inc;
  p.sin_hole = ahead_.sin_azi;
  p.cos_hole = ahead_.cos_azi;
  ahead_ = AnglesOf(survey_[std::min(k + 1, survey_.size() - 1)]);
  p.sin_azi = p.sin_hole * p.cos_convergence + p.cos_hole * p.sin_convergence;
  p.cos_azi = p.cos_hole * p.cos_convergence - p.sin_hole * p.sin_convergence;
  p.sin_mag = p.sin_hole * magnetic_cos_ + p.cos_hole * magnetic_sin_;
  p.cos_mag = p.cos_hole * magnetic_cos_ - p.sin_hole * magnetic_sin_;
  if (!p.named.empty()) NameStation(k);
}

/// What formulas speak of, at this station.
void StationPlaces::NameStation(std::size_t k) {
  using N = FormulaName;
  const SurveyPoint &here = survey_[k], &before = survey_[k > 0 ? k - 1 : 0];
  const auto put = [&](N name, double value) { named_[static_cast<std::size_t>(name)] = value; };
  const auto azimuths = [&](const SurveyPoint& p, N own, N to_true, N magnetic) {
    put(own, p.azimuth);
    put(to_true, p.azimuth + surroundings_.convergence);
    put(magnetic, p.azimuth + surroundings_.convergence - surroundings_.declination.value_or(0));
  };
  azimuths(here, N::kAz, N::kAzT, N::kAzM);
  azimuths(before, N::kAzPrev, N::kAzTPrev, N::kAzMPrev);
  put(N::kAzi, here.azimuth);
  put(N::kInc, here.inclination);
  put(N::kIncPrev, before.inclination);
  for (const N name : {N::kMd, N::kTmd}) put(name, here.md);
  put(N::kMdPrev, before.md);
  put(N::kDmd, here.md - before.md);
  put(N::kTvd, here.tvd);
  put(N::kSide, here.inclination > kPi / 2 ? -1 : 1);
  put(N::kTortuosity, model_->tortuosity.value_or(0));
  put(N::kNoiseReduction,
      model_->stationary ? model_->stationary->noise_reduction.value_or(1) : 1.0);
}

Eigen::Vector3d StationPlaces::TangentBelow() const {
  return {ahead_.sin_inc * ahead_.cos_azi, ahead_.sin_inc * ahead_.sin_azi, ahead_.cos_inc};
}

}  // namespace wellgyro
