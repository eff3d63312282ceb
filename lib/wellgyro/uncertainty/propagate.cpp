#include "wellgyro/uncertainty/propagate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/uncertainty/error_sources_internal.h"
#include "wellgyro/uncertainty/leg_weights_internal.h"
#include "wellgyro/uncertainty/survey_check_internal.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// How errors of (MD, inclination, azimuth) at one station move its own position (`at`) and that of
/// all deeper ones (`through`); beside them, an error along a fixed direction in place of the
/// angles.
struct Sensitivity {
  Matrix3d at, through;
  double along_at = 0, along_through = 0;  ///< [m]
};

/// The hole's direction at a station, with its derivatives.
struct Direction {
  Vector3d t, t_inc, t_azi;
};

Direction DirectionAt(const WeightPlace& p) {
  return {{p.sin_inc * p.cos_hole, p.sin_inc * p.sin_hole, p.cos_inc},
          {p.cos_inc * p.cos_hole, p.cos_inc * p.sin_hole, -p.sin_inc},
          {-p.sin_inc * p.sin_hole, p.sin_inc * p.cos_hole, 0}};
}

/// Balanced tangential: half of the course on either side goes along the station's direction.
/// `behind` and `ahead` are the courses' lengths, `own` what of the first is this station's.
Sensitivity SensitivityAt(const Vector3d& above, const Direction& here, const Vector3d& below,
                          double own, double ahead) {
  Sensitivity s;
  s.at.col(0) = (above + here.t) / 2;
  s.at.col(1) = own * here.t_inc;
  s.at.col(2) = own * here.t_azi;
  s.along_at = own;
  s.along_through = own + ahead / 2;
  s.through.col(0) = s.at.col(0) - (here.t + below) / 2;
  s.through.col(1) = s.along_through * here.t_inc;
  s.through.col(2) = s.along_through * here.t_azi;
  return s;
}

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

std::string At(const SurveyPoint& point) {
  return "MD " + std::to_string(point.md) + " m, inclination " +
         std::to_string(ToDegrees(point.inclination)) + " deg: ";
}

class Propagator {
 public:
  Propagator(std::span<const SurveyPoint> survey, const Surroundings& surroundings,
             std::span<const ToolLeg> legs, const PropagateOptions& options);
  PositionUncertainty Run();

 private:
  void StartLeg(std::size_t leg);
  void PlaceAt(std::size_t k);
  void First();
  bool Station(std::size_t k);
  bool AddTerm(std::size_t term, std::size_t k, const Sensitivity& s);
  void Refuse(std::size_t k, const std::string& term, const std::string& why);
  void Note();

  std::span<const SurveyPoint> survey_;
  std::span<const ToolLeg> tool_legs_;
  std::vector<LegWeights> legs_;
  std::vector<std::vector<std::size_t>> leg_sources_;
  ErrorSources sources_;
  WeightPlace place_;
  double magnetic_sin_ = 0, magnetic_cos_ = 1;  ///< of magnetic less survey azimuth
  std::size_t leg_ = 0;
  Direction here_;
  PositionUncertainty result_;
};

Propagator::Propagator(std::span<const SurveyPoint> survey, const Surroundings& surroundings,
                       std::span<const ToolLeg> legs, const PropagateOptions& options)
    : survey_(survey),
      tool_legs_(legs),

      sources_(options),
      place_(PlaceIn(surroundings, survey.front())) {
  const double to_magnetic = surroundings.convergence - surroundings.declination.value_or(0);
  magnetic_sin_ = std::sin(to_magnetic);
  magnetic_cos_ = std::cos(to_magnetic);
  for (const ToolLeg& leg : legs) {
    legs_.emplace_back(*leg.model, surroundings);
    std::vector<std::size_t>& of_leg = leg_sources_.emplace_back();
    for (const ErrorTerm& term : leg.model->terms) {
      of_leg.push_back(sources_.SourceOf(term, leg, legs_.size() - 1));
    }
  }
  sources_.Open(survey.size(), result_);
}

void Propagator::StartLeg(std::size_t leg) {
  leg_ = leg;
  const ErrorModel& model = legs_[leg].model();
  place_.cant = model.cant.value_or(0);
  place_.min_course_length = model.min_course_length.value_or(0);
  place_.tortuosity = model.tortuosity.value_or(0);
  sources_.StartLeg(leg_sources_[leg]);
}

void Propagator::PlaceAt(std::size_t k) {
  const SurveyPoint& point = survey_[k];
  const SurveyPoint& previous = survey_[k > 0 ? k - 1 : 0];
  const bool from_vertical = previous.inclination < legs_[leg_].model().vertical_limit;
  WeightPlace& p = place_;
  p.md = point.md;
  p.tvd = point.tvd;
  p.course = point.md - previous.md;
  p.inclination = point.inclination;
  p.previous_inclination = previous.inclination;
  p.azimuth_change = from_vertical ? 0 : point.azimuth - previous.azimuth;
  p.sin_inc = std::sin(point.inclination);
  p.cos_inc = std::cos(point.inclination);
  p.sin_hole = std::sin(point.azimuth);
  p.cos_hole = std::cos(point.azimuth);
  p.sin_azi = p.sin_hole * p.cos_convergence + p.cos_hole * p.sin_convergence;
  p.cos_azi = p.cos_hole * p.cos_convergence - p.sin_hole * p.sin_convergence;
  p.sin_mag = p.sin_hole * magnetic_cos_ + p.cos_hole * magnetic_sin_;
  p.cos_mag = p.cos_hole * magnetic_cos_ - p.sin_hole * magnetic_sin_;
}

/// The root: at the surface the depth reference is uncertain, and that is this station's alone.
void Propagator::First() {
  StartLeg(0);
  PlaceAt(0);
  here_ = DirectionAt(place_);
  for (LegWeights& leg : legs_) leg.Begin(survey_[0]);
  const ErrorModel& model = legs_[0].model();
  for (std::size_t i = 0; i < model.terms.size(); ++i) {
    const ErrorTerm& term = model.terms[i];
    if (survey_[0].md != 0 || term.weight->role != WeightRole::kPlain) continue;
    const Vector3d e = term.magnitude * term.weight->at(place_).md * here_.t;
    sources_.Add(leg_sources_[0][i], 0, e, Vector3d::Zero());
  }
  sources_.Give(result_);
}

void Propagator::Refuse(std::size_t k, const std::string& term, const std::string& why) {
  result_.refusal = Refusal{k, term, At(survey_[k]) + why};
}

bool Propagator::AddTerm(std::size_t term, std::size_t k, const Sensitivity& s) {
  LegWeights& leg = legs_[leg_];
  const ErrorTerm& model_term = leg.model().terms[term];
  const WeightFunction& weight = *model_term.weight;
  const std::size_t source = leg_sources_[leg_][term];
  const std::int64_t group = leg.Group(term, k);
  const bool vertical = place_.inclination < leg.model().vertical_limit;
  if (weight.vector && (vertical || weight.role == WeightRole::kCourse)) {
    const bool course = weight.role == WeightRole::kCourse;  // a displacement, not a direction
    const Vector3d v = model_term.magnitude * weight.vector(place_);
    sources_.Add(source, group, (course ? 1 : s.along_at) * v, (course ? 1 : s.along_through) * v);
    return true;
  }
  std::string why;
  const std::optional<Weights> w = leg.Weigh(term, place_, why);
  if (!w) return Refuse(k, model_term.name, why), false;
  const Vector3d e = model_term.magnitude * Vector3d(w->md, w->inclination, w->azimuth);
  sources_.Add(source, group, s.at * e, s.through * e);
  return true;
}

bool Propagator::Station(std::size_t k) {
  if (k == tool_legs_[leg_].end) StartLeg(leg_ + 1);
  const Direction above = here_;
  PlaceAt(k);
  here_ = DirectionAt(place_);
  for (LegWeights& leg : legs_) leg.Advance(survey_[k - 1], survey_[k]);
  LegWeights& leg = legs_[leg_];
  if (std::string why = leg.WhyNot(survey_[k]); !why.empty()) return Refuse(k, {}, why), false;
  const SurveyPoint& next = survey_[std::min(k + 1, survey_.size() - 1)];
  const bool whole = k == 1 && leg.model().doubled_tie_on;
  const Sensitivity s =
      SensitivityAt(above.t, here_, Tangent(next.inclination, next.azimuth),
                    whole ? place_.course : place_.course / 2, next.md - survey_[k].md);
  for (std::size_t i = 0; i < leg.model().terms.size(); ++i) {
    if (!AddTerm(i, k, s)) return false;
  }
  sources_.Give(result_);
  return true;
}

void Propagator::Note() {
  const auto began_above = [](const LegWeights& leg) { return leg.tracker().began_above(); };
  if (std::ranges::any_of(legs_, began_above)) {
    result_.notes.emplace_back(
        "the survey begins above the inclination at which the tool is initialised: taken as "
        "initialised at the first station");
  }
  if (survey_[0].md != 0) {
    result_.notes.emplace_back(
        "the survey begins below MD 0: its first station has the tie-in's covariance only");
  }
}

PositionUncertainty Propagator::Run() {
  First();
  for (std::size_t k = 1; k < survey_.size(); ++k) {
    if (!Station(k)) break;
  }
  Note();
  return std::move(result_);
}

/// The survey with the azimuth of vertical stations set to 0, as the published listings have it.
std::vector<SurveyPoint> WithoutVerticalAzimuths(std::span<const SurveyPoint> survey,
                                                 std::span<const ToolLeg> legs) {
  std::vector<SurveyPoint> points(survey.begin(), survey.end());
  for (const ToolLeg& leg : legs) {
    for (std::size_t k = leg.begin; k < leg.end; ++k) {
      if (points[k].inclination < leg.model->vertical_limit) points[k].azimuth = 0;
    }
  }
  return points;
}

}  // namespace

PositionUncertainty PropagateErrors(std::span<const SurveyPoint> survey,
                                    const Surroundings& surroundings, std::span<const ToolLeg> legs,
                                    const PropagateOptions& options) {
  CheckSurvey(survey);
  CheckSurroundings(surroundings);
  CheckLegs(legs, survey.size(), surroundings);
  const std::vector<SurveyPoint> points = WithoutVerticalAzimuths(survey, legs);
  return Propagator(points, surroundings, legs, options).Run();
}

PositionUncertainty PropagateErrors(std::span<const SurveyPoint> survey,
                                    const Surroundings& surroundings, const ErrorModel& model,
                                    const PropagateOptions& options) {
  const ToolLeg leg{&model, 0, survey.size(), 1};
  return PropagateErrors(survey, surroundings, std::span(&leg, 1), options);
}

}  // namespace wellgyro
