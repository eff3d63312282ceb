#include "wellgyro/uncertainty/propagate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/uncertainty/error_sources_internal.h"
#include "wellgyro/uncertainty/formula_weight.h"
#include "wellgyro/uncertainty/leg_weights_internal.h"
#include "wellgyro/uncertainty/position_sensitivity_internal.h"
#include "wellgyro/uncertainty/station_errors.h"
#include "wellgyro/uncertainty/station_places_internal.h"
#include "wellgyro/uncertainty/survey_check_internal.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::string At(const SurveyPoint& point) {
  return "MD " + std::to_string(point.md) + " m, inclination " +
         std::to_string(ToDegrees(point.inclination)) + " deg: ";
}

class Propagator {
 public:
  Propagator(std::span<const SurveyPoint> survey, const Surroundings& surroundings,
             std::span<const ToolLeg> legs, const PropagateOptions& options,
             SurveyErrors* told = nullptr);
  PositionUncertainty Run();

 private:
  void StartLeg(std::size_t leg);
  void First();
  void AddTie();
  bool Station(std::size_t k);
  bool AddTerm(std::size_t term, std::size_t k, const PositionSensitivity& s);
  void TellFirst();
  void Tell(std::size_t term, std::size_t k, StationError error);
  void Refuse(std::size_t k, const std::string& term, const std::string& why);
  void Note();

  std::span<const SurveyPoint> survey_;
  std::span<const ToolLeg> tool_legs_;
  std::vector<LegWeights> legs_;
  std::vector<std::vector<std::size_t>> leg_sources_;
  ErrorSources sources_;
  StationPlaces places_;
  TieOn tie_on_;
  std::optional<std::size_t> zero_at_;
  std::size_t leg_ = 0;
  StationDirection here_;
  PositionUncertainty result_;
  SurveyErrors* told_;  ///< hears each station's errors; null: nobody asked
};

Propagator::Propagator(std::span<const SurveyPoint> survey, const Surroundings& surroundings,
                       std::span<const ToolLeg> legs, const PropagateOptions& options,
                       SurveyErrors* told)
    : survey_(survey),
      tool_legs_(legs),
      sources_(options),
      places_(survey, surroundings),
      tie_on_(options.tie_on),
      zero_at_(options.zero_at),
      told_(told) {
  for (const ToolLeg& leg : legs) {
    legs_.emplace_back(*leg.model, surroundings);
    std::vector<std::size_t>& of_leg = leg_sources_.emplace_back();
    for (const ErrorTerm& term : leg.model->terms) {
      of_leg.push_back(sources_.SourceOf(term, leg, legs_.size() - 1));
      if (told_ && of_leg.back() == told_->sources.size()) {
        told_->sources.push_back({term.name, term.propagation, leg.model->name, leg.run});
      }
    }
  }
  sources_.Open(survey.size(), result_);
  const auto has_formula = [](const LegWeights& leg) {
    return std::ranges::any_of(leg.model().terms,
                               [](const auto& t) { return t.formula != nullptr; });
  };
  if (std::ranges::any_of(legs_, has_formula)) places_.NameValues();
}

void Propagator::StartLeg(std::size_t leg) {
  leg_ = leg;
  places_.StartLeg(legs_[leg].model());
  sources_.StartLeg(leg_sources_[leg]);
}

/// The root: at the surface the depth reference is uncertain, and that is this station's alone.
void Propagator::First() {
  StartLeg(0);
  places_.MoveTo(0);
  here_ = DirectionAt(places_.place());
  for (LegWeights& leg : legs_) leg.Begin(survey_[0]);
  const ErrorModel& model = legs_[0].model();
  for (std::size_t i = 0; i < model.terms.size(); ++i) {
    const ErrorTerm& term = model.terms[i];
    if (survey_[0].md != 0 || term.weight->role != WeightRole::kPlain) continue;
    const double md = term.formula ? term.formula->At(places_.place().named).md
                                   : term.weight->at(places_.place()).md;
    const Vector3d e = term.magnitude * (std::isfinite(md) ? md : 0) * here_.tangent_W;
    sources_.Add(leg_sources_[0][i], 0, e, Vector3d::Zero());
  }
  if (tie_on_ == TieOn::kIndependent) AddTie();
  if (told_) TellFirst();
  sources_.Give(result_);
}

void Propagator::Tell(std::size_t term, std::size_t k, StationError error) {
  if (!told_) return;
  error.source = leg_sources_[leg_][term];
  error.group = legs_[leg_].Group(term, k);
  error.station = k;
  told_->errors.push_back(error);
}

/// The root's depth, or where the survey begins below it all that the model says of a station.
void Propagator::TellFirst() {
  const bool root = survey_[0].md == 0;
  told_->first_is_measured = !root;
  told_->doubled_tie_on = root && legs_[0].model().doubled_tie_on;
  // Where the sums stay away from: nothing of it reaches a position.
  const PositionSensitivity none{Matrix3d::Zero(), Matrix3d::Zero()};
  for (std::size_t i = 0; i < legs_[0].model().terms.size(); ++i) {
    const ErrorTerm& term = legs_[0].model().terms[i];
    if (!root) {
      if (!AddTerm(i, 0, none)) return;
    } else if (term.weight->role == WeightRole::kPlain) {
      const double md = term.formula ? term.formula->At(places_.place().named).md
                                     : term.weight->at(places_.place()).md;
      if (std::isfinite(md) && md != 0) Tell(i, 0, {.md = term.magnitude * md});
    }
  }
}

/// The first station as another run surveyed it: its direction holds over half of the first leg,
/// and its depth, which is the well's from the datum on, moves what is below where the leg bends.
/// What reaches beyond a run goes on in its group; the rest has one of its own, shared with
/// nothing.
void Propagator::AddTie() {
  constexpr std::int64_t kOfThisRun = std::numeric_limits<std::int64_t>::min();
  LegWeights& leg = legs_[0];
  const double half = (survey_[1].md - survey_[0].md) / 2;
  const bool vertical = places_.place().inclination < leg.model().vertical_limit;
  const Matrix3d through =
      SensitivityFrom(here_, Tangent(survey_[1].inclination, survey_[1].azimuth), 2 * half)
          .through_by_md_inc_azi_W;
  for (std::size_t i = 0; i < leg.model().terms.size(); ++i) {
    const ErrorTerm& term = leg.model().terms[i];
    if (term.weight->role == WeightRole::kCourse) continue;
    const bool reaches = term.propagation == Propagation::kWell ||  //
                         term.propagation == Propagation::kGlobal;
    Vector3d e = Vector3d::Zero();
    std::string why;
    if (const auto v = leg.Displacement(i, places_.place(), vertical)) {
      e = half * *v;
    } else if (const auto w = leg.Weigh(i, places_.place(), why)) {
      e = through * Vector3d(w->md, w->inclination, w->azimuth);
    }
    sources_.Add(leg_sources_[0][i], reaches ? leg.Group(i, 0) : kOfThisRun, Vector3d::Zero(),
                 term.magnitude * e);
  }
}

void Propagator::Refuse(std::size_t k, const std::string& term, const std::string& why) {
  result_.refusal = Refusal{k, term, At(survey_[k]) + why};
}

bool Propagator::AddTerm(std::size_t term, std::size_t k, const PositionSensitivity& s) {
  LegWeights& leg = legs_[leg_];
  const ErrorTerm& model_term = leg.model().terms[term];
  const WeightFunction& weight = *model_term.weight;
  const std::size_t source = leg_sources_[leg_][term];
  const std::int64_t group = leg.Group(term, k);
  const bool vertical = places_.place().inclination < leg.model().vertical_limit;
  const bool displaces = model_term.formula || weight.vector;  // spares a call a station and term
  const auto unit = displaces ? leg.Displacement(term, places_.place(), vertical) : std::nullopt;
  if (unit) {
    const bool course = weight.role == WeightRole::kCourse;  // a displacement, not a direction
    if (course && zero_at_ == k) return true;
    if (!unit->allFinite()) {
      return Refuse(k, model_term.name, "the term's formula has no value in a vertical hole"),
             false;
    }
    const Vector3d v = model_term.magnitude * *unit;
    if (course) {
      Tell(term, k, {.displacement_W = v});
    } else {
      Tell(term, k, {.direction_W = v});
    }
    sources_.Add(source, group, (course ? 1 : s.along_at) * v, (course ? 1 : s.along_through) * v);
    return true;
  }
  std::string why;
  const std::optional<Weights> w = leg.Weigh(term, places_.place(), why);
  if (!w) return Refuse(k, model_term.name, why), false;
  const Vector3d e = model_term.magnitude * Vector3d(w->md, w->inclination, w->azimuth);
  Tell(term, k, {.md = e.x(), .direction_W = e.y() * here_.high_side_W + e.z() * here_.right_W});
  if (e.x() == 0 && e.y() == 0) {  // most terms move the azimuth alone
    sources_.Add(source, group, e.z() * s.at_by_md_inc_azi_W.col(2),
                 e.z() * s.through_by_md_inc_azi_W.col(2));
  } else {
    sources_.Add(source, group, s.at_by_md_inc_azi_W * e, s.through_by_md_inc_azi_W * e);
  }
  return true;
}

bool Propagator::Station(std::size_t k) {
  if (k == tool_legs_[leg_].end) StartLeg(leg_ + 1);
  const StationDirection above = here_;
  places_.MoveTo(k);
  here_ = DirectionAt(places_.place());
  for (LegWeights& leg : legs_) leg.Advance(survey_[k - 1], survey_[k]);
  LegWeights& leg = legs_[leg_];
  if (std::string why = leg.WhyNot(survey_[k]); !why.empty()) return Refuse(k, {}, why), false;
  const SurveyPoint& next = survey_[std::min(k + 1, survey_.size() - 1)];
  const bool doubled =
      tie_on_ == TieOn::kModel ? leg.model().doubled_tie_on : tie_on_ == TieOn::kWhole;
  const bool whole = k == 1 && doubled;
  const Vector3d below = places_.TangentBelow();
  const double ahead = next.md - survey_[k].md;
  PositionSensitivity s =
      SensitivityAt(above.tangent_W, here_, below,
                    whole ? places_.place().course : places_.place().course / 2, ahead);
  if (zero_at_ == k) {
    sources_.Forget();
    s = SensitivityFrom(here_, below, ahead);
  }
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
  for (const ToolLeg& leg : tool_legs_) {
    for (const std::string& note : leg.model->notes) {
      const std::string text = "model " + leg.model->name + ": " + note;
      if (std::ranges::find(result_.notes, text) == result_.notes.end()) {
        result_.notes.push_back(text);
      }
    }
  }
  if (survey_[0].md != 0) {
    result_.notes.emplace_back(
        "the survey does not begin at MD 0: its first station has the tie-in's covariance only");
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

}  // namespace

PositionUncertainty PropagateErrors(std::span<const SurveyPoint> survey,
                                    const Surroundings& surroundings, std::span<const ToolLeg> legs,
                                    const PropagateOptions& options) {
  CheckSurvey(survey);
  CheckSurroundings(surroundings);
  CheckLegs(legs, survey.size(), surroundings);
  if (options.zero_at && (*options.zero_at == 0 || *options.zero_at + 1 >= survey.size())) {
    throw std::invalid_argument("errors cannot begin to count at the first or last station");
  }
  int changed = 0;
  const std::vector<SurveyPoint> points = WithoutVerticalAzimuths(survey, legs, changed);
  PositionUncertainty result = Propagator(points, surroundings, legs, options).Run();
  if (changed > 0) {
    result.notes.push_back("the listed azimuth of " + std::to_string(changed) +
                           " exactly vertical stations is not used: it is taken as 0");
  }
  return result;
}

SurveyErrors ErrorsAtStations(std::span<const SurveyPoint> survey, const Surroundings& surroundings,
                              std::span<const ToolLeg> legs) {
  CheckSurvey(survey);
  CheckSurroundings(surroundings);
  CheckLegs(legs, survey.size(), surroundings);
  int changed = 0;
  const std::vector<SurveyPoint> points = WithoutVerticalAzimuths(survey, legs, changed);
  const PropagateOptions options;
  SurveyErrors errors;
  PositionUncertainty sums = Propagator(points, surroundings, legs, options, &errors).Run();
  errors.stations = sums.cov_p_W.size();
  if (sums.refusal && sums.refusal->station == 0) errors.stations = 0;
  errors.refusal = std::move(sums.refusal);
  const auto order = [](const StationError& e) { return std::tuple(e.source, e.group, e.station); };
  std::ranges::sort(errors.errors, {}, order);
  return errors;
}

PositionUncertainty PropagateErrors(std::span<const SurveyPoint> survey,
                                    const Surroundings& surroundings, const ErrorModel& model,
                                    const PropagateOptions& options) {
  const ToolLeg leg{&model, 0, survey.size(), 1};
  return PropagateErrors(survey, surroundings, std::span(&leg, 1), options);
}

}  // namespace wellgyro
