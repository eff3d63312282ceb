#include "wellgyro/uncertainty/propagate.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/uncertainty/gyro_mode.h"
#include "wellgyro/uncertainty/survey_check_internal.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// How errors at one station move its own position (`at`) and that of all deeper ones (`through`).
struct Sensitivity {
  Matrix3d at, through;
  double course_at = 0, course_through = 0;  ///< the same for an error along a fixed direction [m]
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

/// Balanced tangential, of station k between the directions of its neighbours; `below` and `ahead`
/// are null and 0 at the end.
Sensitivity SensitivityAt(const Vector3d& above, const Direction& here, const Vector3d* below,
                          double behind, double ahead, bool doubled) {
  Sensitivity s;
  const double own = doubled ? behind : behind / 2;
  s.at.col(0) = (above + here.t) / 2;
  s.at.col(1) = own * here.t_inc;
  s.at.col(2) = own * here.t_azi;
  s.course_at = own;
  s.course_through = own + ahead / 2;
  s.through = s.at;
  if (!below) return s;
  s.through.col(0) -= (here.t + *below) / 2;
  s.through.col(1) += ahead / 2 * here.t_inc;
  s.through.col(2) += ahead / 2 * here.t_azi;
  return s;
}

/// One error that lives on: it adds up while its group lasts, and its groups are independent.
struct Source {
  std::string name;
  Propagation propagation = Propagation::kSystematic;
  int run = 0;                        ///< of systematic ones
  const ErrorModel* model = nullptr;  ///< of systematic ones
  bool active = false;
  std::int64_t group = 0;
  Vector3d sum = Vector3d::Zero();
  Vector3d error = Vector3d::Zero();   ///< at this station
  Matrix3d closed = Matrix3d::Zero();  ///< covariance of the groups that ended
};

/// One term of one leg, and what it carries from the fix that opened a section.
struct LegTerm {
  const ErrorTerm* term = nullptr;
  std::size_t source = 0;
  std::size_t zone = 0;
  int carried_section = 0;
  double carried_azimuth = 0;
};

struct Leg {
  const ErrorModel* model = nullptr;
  std::vector<LegTerm> terms;
  GyroModeTracker tracker;
};

bool IsStationary(WeightRole role) {
  return role == WeightRole::kStationary || role == WeightRole::kStationaryNoise;
}

std::string InText(double value) {
  std::string text = std::to_string(value);  // six decimals, no locale beyond the point's
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

class Propagator {
 public:
  Propagator(std::span<const SurveyPoint> survey, const Surroundings& place,
             std::span<const ToolLeg> legs, const PropagateOptions& options);
  PositionUncertainty Run();

 private:
  void AddLeg(const ToolLeg& tool_leg);
  std::size_t SourceOf(const ErrorTerm& term, const ToolLeg& leg);
  void PlaceAt(std::size_t k);
  void UseModel(const ErrorModel& model);
  void StartLeg(std::size_t number);
  void First();
  bool Station(std::size_t k);
  bool Refuse(std::size_t k, const std::string& term, const std::string& why);
  std::string WhyNotServed(const Leg& leg, const GyroMode& mode, std::size_t k) const;
  bool Weigh(Leg& leg, LegTerm& term, const GyroMode& mode, std::size_t k, Weights& w);
  double Carried(LegTerm& term, const Leg& leg, const GyroMode& mode) const;
  void Add(Source& source, std::int64_t group, const Vector3d& at, const Vector3d& through);
  void Close(Source& source);
  void Give();

  std::span<const SurveyPoint> survey_;
  const Surroundings& surroundings_;
  std::span<const ToolLeg> tool_legs_;
  const PropagateOptions& options_;
  std::vector<Leg> legs_;
  std::vector<Source> sources_;
  std::vector<std::size_t> shared_;  ///< sources of result_.shared
  WeightPlace place_;
  double vertical_limit_ = 0;
  double convergence_sin_ = 0, convergence_cos_ = 1, magnetic_sin_ = 0, magnetic_cos_ = 1;
  Direction above_, here_;
  Matrix3d settled_ = Matrix3d::Zero();  ///< tie-in, closed groups
  Matrix3d idle_ = Matrix3d::Zero();     ///< open groups of sources that this leg does not have
  Matrix3d total_ = Matrix3d::Zero();
  PositionUncertainty result_;
};

Propagator::Propagator(std::span<const SurveyPoint> survey, const Surroundings& place,
                       std::span<const ToolLeg> legs, const PropagateOptions& options)
    : survey_(survey), surroundings_(place), tool_legs_(legs), options_(options) {
  settled_ = options.cov_tie_in;
  convergence_sin_ = std::sin(place.convergence);
  convergence_cos_ = std::cos(place.convergence);
  const double to_magnetic = place.convergence - place.declination.value_or(0);
  magnetic_sin_ = std::sin(to_magnetic);
  magnetic_cos_ = std::cos(to_magnetic);
  place_.sin_convergence = convergence_sin_;
  place_.cos_convergence = convergence_cos_;
  place_.cos_latitude = std::cos(place.latitude);
  place_.tan_latitude = std::tan(place.latitude);
  place_.horizontal_earth_rate = kEarthRate * place_.cos_latitude;
  place_.gravity = place.gravity;
  if (place.field && place.dip) {
    place_.horizontal_field = *place.field * std::cos(*place.dip);
    place_.tan_dip = std::tan(*place.dip);
  }
  place_.tie_sin_inc = std::sin(survey.front().inclination);
  for (const ToolLeg& leg : legs) AddLeg(leg);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& source = sources_[i];
    if (source.propagation == Propagation::kWell || source.propagation == Propagation::kGlobal) {
      shared_.push_back(i);
      result_.shared.push_back({source.name, source.propagation, {}});
      result_.shared.back().error_p.reserve(survey.size());
    }
    if (options.terms) result_.terms.push_back({source.name, {}});
  }
  result_.cov_p.reserve(survey.size());
  for (auto& term : result_.terms) term.cov_p.reserve(survey.size());
}

std::size_t Propagator::SourceOf(const ErrorTerm& term, const ToolLeg& leg) {
  const bool within_leg =
      term.propagation == Propagation::kRandom || term.propagation == Propagation::kSystematic;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& s = sources_[i];
    if (s.name != term.name || s.propagation != term.propagation) continue;
    if (!within_leg || (s.run == leg.run && s.model == leg.model)) return i;
  }
  Source source;
  source.name = term.name;
  source.propagation = term.propagation;
  source.run = leg.run;
  source.model = leg.model;
  sources_.push_back(std::move(source));
  return sources_.size() - 1;
}

void Propagator::AddLeg(const ToolLeg& tool_leg) {
  const ErrorModel& model = *tool_leg.model;
  Leg leg{&model, {}, GyroModeTracker(model)};
  for (const ErrorTerm& term : model.terms) {
    LegTerm entry;
    entry.term = &term;
    entry.source = SourceOf(term, tool_leg);
    const auto zone =
        std::ranges::find(model.continuous, term.weight->axes,
                          [](const ContinuousZone& z) { return std::optional<GyroAxes>(z.axes); });
    entry.zone = static_cast<std::size_t>(zone - model.continuous.begin());
    leg.terms.push_back(entry);
  }
  legs_.push_back(std::move(leg));
}

void Propagator::UseModel(const ErrorModel& model) {
  vertical_limit_ = model.vertical_limit;
  place_.cant = model.cant.value_or(0);
  place_.min_course_length = model.min_course_length.value_or(0);
  place_.tortuosity = model.tortuosity.value_or(0);
}

void Propagator::PlaceAt(std::size_t k) {
  const SurveyPoint& point = survey_[k];
  WeightPlace& p = place_;
  p.md = point.md;
  p.tvd = point.tvd;
  p.previous_inclination = k > 0 ? p.inclination : point.inclination;
  p.inclination = point.inclination;
  p.sin_inc = std::sin(point.inclination);
  p.cos_inc = std::cos(point.inclination);
  p.sin_hole = std::sin(point.azimuth);
  p.cos_hole = std::cos(point.azimuth);
  if (k > 0) {
    p.course = point.md - survey_[k - 1].md;
    const bool from_vertical = survey_[k - 1].inclination < vertical_limit_;
    p.azimuth_change = from_vertical ? 0 : WrapPi(point.azimuth - survey_[k - 1].azimuth);
  }
  p.sin_azi = p.sin_hole * convergence_cos_ + p.cos_hole * convergence_sin_;
  p.cos_azi = p.cos_hole * convergence_cos_ - p.sin_hole * convergence_sin_;
  p.sin_mag = p.sin_hole * magnetic_cos_ + p.cos_hole * magnetic_sin_;
  p.cos_mag = p.cos_hole * magnetic_cos_ - p.sin_hole * magnetic_sin_;
}

/// What the sources of other legs have come to stays as it is while this leg lasts.
void Propagator::StartLeg(std::size_t number) {
  for (Source& source : sources_) source.active = false;
  for (const LegTerm& term : legs_[number].terms) sources_[term.source].active = true;
  idle_.setZero();
  for (Source& source : sources_) {
    if (source.active) continue;
    source.error = source.sum;
    idle_ += source.sum * source.sum.transpose();
  }
  UseModel(*legs_[number].model);
}

bool Propagator::Refuse(std::size_t k, const std::string& term, const std::string& why) {
  Refusal refusal{k, term, {}};
  refusal.text = "MD " + InText(survey_[k].md) + " m, inclination " +
                 InText(ToDegrees(survey_[k].inclination)) + " deg: " + why;
  result_.refusal = std::move(refusal);
  return false;
}

std::string Propagator::WhyNotServed(const Leg& leg, const GyroMode& mode, std::size_t k) const {
  const ErrorModel& model = *leg.model;
  constexpr double kRounding = 1e-12;
  const double inclination = survey_[k].inclination;
  if (inclination > model.max_inclination + kRounding)
    return "above the greatest inclination of model " + model.name + ", " +
           InText(ToDegrees(model.max_inclination)) + " deg";
  if (!mode.refusal.empty()) return "model " + model.name + ": " + mode.refusal;
  if (mode.section == 0 && model.stationary && model.continuous.empty() &&
      inclination > model.stationary->end + kRounding)
    return "above the end of the stationary range of model " + model.name + ", " +
           InText(ToDegrees(model.stationary->end)) + " deg";
  return {};
}

/// Azimuth error of the fix that opened the section, per unit of the magnitude.
double Propagator::Carried(LegTerm& term, const Leg& leg, const GyroMode& mode) const {
  if (term.carried_section == mode.section) return term.carried_azimuth;
  WeightPlace p = place_;
  const double azimuth = mode.init_azimuth + surroundings_.convergence;
  p.inclination = mode.init_inclination;
  p.sin_inc = std::sin(p.inclination);
  p.cos_inc = std::cos(p.inclination);
  p.sin_azi = std::sin(azimuth);
  p.cos_azi = std::cos(azimuth);
  const WeightFunction& weight = *term.term->weight;
  term.carried_azimuth = weight.at(p).azimuth;
  if (weight.role == WeightRole::kStationaryNoise)
    term.carried_azimuth *= leg.model->stationary->noise_reduction.value_or(1);
  term.carried_section = mode.section;
  return term.carried_azimuth;
}

constexpr double kNearSingular = 0.017452406437283512 * (1 - 1e-9);  // sin 1 deg

/// Weights of `term` at station k; false, with the refusal, where they are not to be trusted.
bool Propagator::Weigh(Leg& leg, LegTerm& term, const GyroMode& mode, std::size_t k, Weights& w) {
  const WeightFunction& weight = *term.term->weight;
  switch (weight.role) {
    case WeightRole::kDrift:
      w = {0, 0, mode.drift_time[term.zone]};
      return true;
    case WeightRole::kWalk:
      w = {0, 0, std::sqrt(mode.walk_time[term.zone])};
      return true;
    case WeightRole::kStationary:
    case WeightRole::kStationaryNoise:
      if (mode.section == 0) break;
      if (weight.denominator && std::abs(std::cos(mode.init_inclination)) < kNearSingular)
        return Refuse(k, term.term->name, "the fix was taken within 1 deg of horizontal");
      w = {0, 0, Carried(term, leg, mode)};
      return true;
    default:
      break;
  }
  if (weight.denominator && std::abs(weight.denominator(place_)) < kNearSingular)
    return Refuse(k, term.term->name,
                  "term " + term.term->name + " of model " + leg.model->name +
                      " is within 1 deg of where it grows beyond all bounds");
  w = weight.at(place_);
  if (weight.role == WeightRole::kStationaryNoise &&
      leg.model->stationary->noise_reduction_at_stations)
    w.azimuth *= leg.model->stationary->noise_reduction.value_or(1);
  return true;
}

void Propagator::Close(Source& source) {
  const Matrix3d ended = source.sum * source.sum.transpose();
  settled_ += ended;
  if (options_.terms) source.closed += ended;
  source.sum.setZero();
}

void Propagator::Add(Source& source, std::int64_t group, const Vector3d& at,
                     const Vector3d& through) {
  if (group != source.group) {
    Close(source);
    source.group = group;
  }
  source.error = source.sum + at;
  source.sum += through;
}

/// Errors add up while this stays the same: a new one at every station for random errors; in
/// continuous survey one for a section, for what is random from one section to the next.
std::int64_t GroupOf(const ErrorTerm& term, const GyroMode& mode, std::size_t k) {
  const WeightRole role = term.weight->role;
  if (role == WeightRole::kWalk) return mode.section;
  if (term.propagation != Propagation::kRandom) return 0;
  if (IsStationary(role) && mode.section > 0) return mode.section;
  return -1 - static_cast<std::int64_t>(k);
}

void Propagator::Give() {
  total_ = settled_ + idle_;
  for (const Source& source : sources_)
    if (source.active) total_ += source.error * source.error.transpose();
  result_.cov_p.push_back(total_);
  for (std::size_t i = 0; i < shared_.size(); ++i)
    result_.shared[i].error_p.push_back(sources_[shared_[i]].error);
  for (std::size_t i = 0; i < result_.terms.size(); ++i) {
    const Source& s = sources_[i];
    result_.terms[i].cov_p.push_back(s.closed + s.error * s.error.transpose());
  }
}

/// The root: only the depth reference is uncertain, and only its own station's.
void Propagator::First() {
  StartLeg(0);
  PlaceAt(0);
  here_ = DirectionAt(place_);
  for (Leg& leg : legs_) leg.tracker.Begin(survey_[0]);
  for (LegTerm& term : legs_[0].terms) {
    const WeightFunction& weight = *term.term->weight;
    const bool at_surface = survey_[0].md == 0 && weight.role == WeightRole::kPlain;
    const double w = at_surface ? weight.at(place_).md : 0;
    sources_[term.source].error = term.term->magnitude * w * here_.t;
  }
  Give();
  for (Source& source : sources_) source.error.setZero();
}

bool Propagator::Station(std::size_t k) {
  std::size_t number = 0;
  while (k >= tool_legs_[number].end) ++number;
  if (k == tool_legs_[number].begin && k > 0) StartLeg(number);
  above_ = here_;
  PlaceAt(k);
  here_ = DirectionAt(place_);
  const bool last = k + 1 == survey_.size();
  const Vector3d below =
      last ? here_.t : Tangent(survey_[k + 1].inclination, survey_[k + 1].azimuth);
  Leg& leg = legs_[number];
  const Sensitivity s = SensitivityAt(above_.t, here_, last ? nullptr : &below, place_.course,
                                      last ? 0 : survey_[k + 1].md - survey_[k].md,
                                      k == 1 && leg.model->doubled_tie_on);
  const GyroMode* mode = nullptr;
  for (Leg& each : legs_) {
    const GyroMode& of_each = each.tracker.Advance(survey_[k - 1], survey_[k]);
    if (&each == &leg) mode = &of_each;
  }
  if (auto why = WhyNotServed(leg, *mode, k); !why.empty()) return Refuse(k, {}, why);
  const bool vertical = place_.inclination < vertical_limit_;
  for (LegTerm& term : leg.terms) {
    const WeightFunction& weight = *term.term->weight;
    const double size = term.term->magnitude;
    Source& source = sources_[term.source];
    const std::int64_t group = GroupOf(*term.term, *mode, k);
    if (weight.role == WeightRole::kCourse) {
      const Vector3d e = size * weight.vector(place_);
      Add(source, group, e, e);
    } else if (vertical && weight.vector) {
      const Vector3d v = size * weight.vector(place_);
      Add(source, group, s.course_at * v, s.course_through * v);
    } else {
      Weights w;
      if (!Weigh(leg, term, *mode, k, w)) return false;
      const Vector3d e = size * Vector3d(w.md, w.inclination, w.azimuth);
      Add(source, group, s.at * e, s.through * e);
    }
  }
  Give();
  return true;
}

PositionUncertainty Propagator::Run() {
  First();
  for (std::size_t k = 1; k < survey_.size(); ++k)
    if (!Station(k)) break;
  const auto began_above = [](const Leg& leg) { return leg.tracker.began_above(); };
  if (std::ranges::any_of(legs_, began_above))
    result_.notes.emplace_back(
        "the survey begins above the inclination at which the tool is initialised: taken as "
        "initialised at the first station");
  if (survey_[0].md != 0)
    result_.notes.emplace_back(
        "the survey begins below MD 0: its first station has the tie-in's covariance only");
  return std::move(result_);
}

/// The survey with the azimuth of vertical stations set to 0, as the published listings have it.
std::vector<SurveyPoint> WithoutVerticalAzimuths(std::span<const SurveyPoint> survey,
                                                 std::span<const ToolLeg> legs) {
  std::vector<SurveyPoint> points(survey.begin(), survey.end());
  for (const ToolLeg& leg : legs)
    for (std::size_t k = leg.begin; k < leg.end; ++k)
      if (points[k].inclination < leg.model->vertical_limit) points[k].azimuth = 0;
  return points;
}

}  // namespace

PositionUncertainty PropagateErrors(std::span<const SurveyPoint> survey, const Surroundings& place,
                                    std::span<const ToolLeg> legs,
                                    const PropagateOptions& options) {
  CheckSurvey(survey);
  CheckSurroundings(place);
  CheckLegs(legs, survey.size(), place);
  const std::vector<SurveyPoint> points = WithoutVerticalAzimuths(survey, legs);
  return Propagator(points, place, legs, options).Run();
}

PositionUncertainty PropagateErrors(std::span<const SurveyPoint> survey, const Surroundings& place,
                                    const ErrorModel& model, const PropagateOptions& options) {
  const ToolLeg leg{&model, 0, survey.size(), 1};
  return PropagateErrors(survey, place, std::span(&leg, 1), options);
}

}  // namespace wellgyro
