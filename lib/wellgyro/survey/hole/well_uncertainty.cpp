#include "wellgyro/survey/hole/well_uncertainty.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "wellgyro/base/units.h"
#include "wellgyro/trajectory/minimum_curvature.h"

namespace wellgyro {
namespace {

// Inclination at which a continuous leg begins, as GYRO-NS-CT has it (data/models).
constexpr double kDefaultInitialise = 15 * units::kDeg;

bool IsContinuous(const ErrorTerm& term) {
  const WeightRole role = term.weight->role;
  return role == WeightRole::kDrift || role == WeightRole::kWalk || role == WeightRole::kRateWalk ||
         role == WeightRole::kRamp;
}

const ErrorModel* OnlyModel(std::span<const ToolLeg> legs) {
  if (legs.empty()) return nullptr;
  const ErrorModel* model = legs.front().model;
  for (const ToolLeg& leg : legs) {
    if (leg.model != model || leg.run != legs.front().run) {
      throw std::invalid_argument(
          "Allan coefficients are those of one tool in one run, not of "
          "several legs");
    }
  }
  if (model->continuous.size() != 1) {
    throw std::invalid_argument("model " + model->name + " has " +
                                std::to_string(model->continuous.size()) +
                                " continuous gyros; Allan coefficients are of one");
  }
  return model;
}

AllanRun RunOf(const UncertaintyBasis& basis, const ErrorModel* model) {
  AllanRun run;
  run.noise = *basis.noise;
  run.sigma_azimuth = basis.sigma_azimuth;
  run.initialise = kDefaultInitialise;
  if (model) {
    run.axes = model->continuous.front().axes;
    run.speed = model->continuous.front().speed;
    run.initialise = model->stationary ? *model->stationary->initialise : -1;
  }
  if (basis.initialise) run.initialise = *basis.initialise;
  if (basis.speed) run.speed = *basis.speed;
  if (run.speed == 0) throw std::invalid_argument("the speed of the tool along hole is needed");
  return run;
}

ErrorModel WithoutDrift(const ErrorModel& model) {
  ErrorModel rest = model;
  std::erase_if(rest.terms, IsContinuous);
  return rest;
}

/// The shorter of both, term lists joined.
void Join(PositionUncertainty& total, PositionUncertainty&& part) {
  const std::size_t n = std::min(total.cov_p_W.size(), part.cov_p_W.size());
  if (part.refusal && (!total.refusal || part.refusal->station < total.refusal->station)) {
    total.refusal = std::move(part.refusal);
  }
  total.cov_p_W.resize(n);
  for (std::size_t k = 0; k < n; ++k) total.cov_p_W[k] += part.cov_p_W[k];
  std::ranges::move(part.terms, std::back_inserter(total.terms));
  std::ranges::move(part.shared, std::back_inserter(total.shared));
  for (std::string& note : part.notes) {
    if (std::ranges::find(total.notes, note) == total.notes.end()) {
      total.notes.push_back(std::move(note));
    }
  }
  for (auto& term : total.terms) term.cov_p_W.resize(n);
  for (auto& shared : total.shared) shared.error_p_W.resize(n);
}

PositionUncertainty ExactPart(const SurveyedWell& well, const AllanRun& run,
                              const PropagateOptions& options) {
  AllanUncertainty allan = AllanErrors(well.survey, run);
  PositionUncertainty part;
  part.cov_p_W = std::move(allan.cov_p_W);
  part.refusal = std::move(allan.refusal);
  part.notes.push_back("Allan terms: exact");
  if (!options.terms) return part;
  for (AllanTerm& term : allan.terms) {
    part.terms.push_back({std::move(term.term), std::move(term.cov_p_W)});
  }
  return part;
}

PositionUncertainty PrintedPart(const SurveyedWell& well, const Surroundings& surroundings,
                                const AllanRun& run, const PropagateOptions& options) {
  PrintedAllan printed = PrintedAllanModel(run);
  PropagateOptions of_part = options;
  of_part.cov_tie_in_W.setZero();
  PositionUncertainty part = PropagateErrors(well.survey, surroundings, printed.model, of_part);
  part.notes.push_back("Allan terms: printed");
  if (run.noise.rate_random_walk > 0 || run.noise.rate_ramp > 0) {
    part.notes.push_back(
        "the printed recursions of rate random walk and ramp begin anew at every station: they "
        "come "
        "out too small, the more the closer the stations are; the exact form does not");
  }
  for (const std::string& name : printed.left_out) {
    part.notes.push_back("the printed form has no term for " + name + ": left out");
  }
  return part;
}

}  // namespace

SurveyedWell SurveyWell(std::vector<SurveyPoint> stations, const Eigen::Vector3d& start_W) {
  std::vector<double> md, inclination, azimuth;
  for (const SurveyPoint& p : stations) {
    md.push_back(p.md);
    inclination.push_back(p.inclination);
    azimuth.push_back(p.azimuth);
  }
  SurveyedWell well;
  well.position_W.resize(stations.size());
  MinimumCurvature(md, inclination, azimuth, start_W, well.position_W);
  for (std::size_t k = 0; k < stations.size(); ++k) stations[k].tvd = well.position_W[k].z();
  well.survey = std::move(stations);
  return well;
}

SurveyedWell SurveyWell(std::span<const Station> stations) {
  SurveyedWell well;
  for (const Station& s : stations) {
    well.survey.push_back({s.md, s.inclination, s.azimuth, s.p_WT_W.z()});
    well.position_W.push_back(s.p_WT_W);
  }
  return well;
}

PositionUncertainty WellUncertainty(const SurveyedWell& well, const Surroundings& surroundings,
                                    const UncertaintyBasis& basis,
                                    const PropagateOptions& options) {
  if (!basis.noise) return PropagateErrors(well.survey, surroundings, basis.legs, options);
  const ErrorModel* model = OnlyModel(basis.legs);
  const AllanRun run = RunOf(basis, model);
  PositionUncertainty total;
  if (model) {
    const ErrorModel rest = WithoutDrift(*model);
    total = PropagateErrors(well.survey, surroundings, rest, options);
  } else {
    total.cov_p_W.assign(well.survey.size(), options.cov_tie_in_W);
  }
  Join(total, basis.form == AllanForm::kExact ? ExactPart(well, run, options)
                                              : PrintedPart(well, surroundings, run, options));
  return total;
}

}  // namespace wellgyro
