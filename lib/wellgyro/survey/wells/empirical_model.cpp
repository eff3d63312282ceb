#include "wellgyro/survey/wells/empirical_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/math/statistics.h"
#include "wellgyro/math/variance_components.h"
#include "wellgyro/survey/wells/repeat_contrasts_internal.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

constexpr const char* kShared =
    "one error in all surveys of a hole: their differences do not show it";
constexpr const char* kInNoSurvey = "no survey that was compared has it";
constexpr const char* kVague = "the surveys tell it neither from 0 nor from what is assumed";

bool IsShared(const ErrorTerm& term) {
  return term.propagation == Propagation::kWell || term.propagation == Propagation::kGlobal;
}

class Estimator {
 public:
  Estimator(std::span<const RepeatedHole> holes, const ErrorModel& assumed,
            const EmpiricalOptions& options);
  EmpiricalModel Run() &&;

 private:
  void GatherHoles(std::span<const RepeatedHole> holes);
  void Hold(std::size_t term, const char* why);
  void HoldWhatIsAbsent();
  bool HoldTheVaguest();
  TermEstimate EstimateOf(std::size_t component, double assumed) const;

  const EmpiricalOptions& options_;
  EmpiricalModel result_;
  std::vector<VarianceCluster> clusters_;
  VarianceStart start_;
  VarianceFit fit_;
  std::vector<VarianceEstimate> intervals_;
};

Estimator::Estimator(std::span<const RepeatedHole> holes, const ErrorModel& assumed,
                     const EmpiricalOptions& options)
    : options_(options) {
  if (!(options.local_sigma > 0 && options.local_sigma < 1)) {
    throw std::invalid_argument("local_sigma is an angle above 0");
  }
  result_.model = assumed;
  const std::size_t components = assumed.terms.size() + 1;
  start_ = {std::vector<double>(components, 1.0), std::vector<bool>(components, false)};
  for (const ErrorTerm& term : assumed.terms) {
    result_.terms.push_back({term.name, term.magnitude, term.magnitude, 0, {}, {}});
  }
  for (std::size_t j = 0; j < assumed.terms.size(); ++j) {
    if (IsShared(assumed.terms[j])) Hold(j, kShared);
  }
  GatherHoles(holes);
  HoldWhatIsAbsent();
}

void Estimator::Hold(std::size_t term, const char* why) {
  start_.held[term] = true;
  result_.terms[term].kept = why;
}

void Estimator::GatherHoles(std::span<const RepeatedHole> holes) {
  const std::vector<bool> known(start_.held.begin(), start_.held.end() - 1);
  for (const RepeatedHole& hole : holes) {
    RepeatContrasts contrasts = ContrastsOf(hole, result_.model, known, options_.local_sigma);
    std::ranges::move(contrasts.notes, std::back_inserter(result_.notes));
    if (contrasts.cluster.y.size() == 0) {
      result_.notes.push_back(
          fmt::format("{}: no two surveys have a depth in common: left out", hole.name));
      continue;
    }
    const auto freedom = static_cast<double>(contrasts.cluster.y.size());
    result_.holes.push_back({hole.name, hole.surveys.size(), contrasts.places, freedom, 0});
    clusters_.push_back(std::move(contrasts.cluster));
  }
  if (clusters_.empty()) {
    throw std::invalid_argument("no hole has two surveys with depths in common");
  }
}

void Estimator::HoldWhatIsAbsent() {
  std::vector<bool> has(start_.held.size(), false);
  for (const VarianceCluster& cluster : clusters_) {
    for (const VarianceSource& source : cluster.sources) {
      if (source.component) has[*source.component] = true;
    }
  }
  for (std::size_t j = 0; j < result_.terms.size(); ++j) {
    if (!has[j] && !start_.held[j]) Hold(j, kInNoSurvey);
  }
}

/// Holds the term of which the surveys say least, if they say nothing: neither 0 nor the assumed
/// variance is beyond its confidence limit, and the larger of the two deviances is the least.
bool Estimator::HoldTheVaguest() {
  const double limit = ChiSquareQuantile(kConfidence, 1);
  std::optional<std::size_t> vaguest;
  double least = limit;
  for (std::size_t j = 0; j < result_.terms.size(); ++j) {
    if (start_.held[j]) continue;
    const double from_none = VarianceDeviance(clusters_, start_, fit_, j, 0);
    if (from_none >= least) continue;
    const double from_assumed = VarianceDeviance(clusters_, start_, fit_, j, 1);
    if (std::max(from_none, from_assumed) >= least) continue;
    vaguest = j;
    least = std::max(from_none, from_assumed);
  }
  if (vaguest) Hold(*vaguest, kVague);
  return vaguest.has_value();
}

TermEstimate Estimator::EstimateOf(std::size_t component, double assumed) const {
  const VarianceEstimate& e = intervals_[component];
  TermEstimate estimate;
  estimate.assumed = assumed;
  estimate.magnitude = assumed * std::sqrt(e.value);
  estimate.lower = assumed * std::sqrt(e.lower);
  if (e.upper) estimate.upper = assumed * std::sqrt(*e.upper);
  return estimate;
}

EmpiricalModel Estimator::Run() && {
  do {
    fit_ = FitVariances(clusters_, start_);
    if (!fit_.converged) result_.notes.emplace_back("the search for the magnitudes did not settle");
  } while (HoldTheVaguest());
  intervals_ = VarianceIntervals(clusters_, start_, fit_, kConfidence);
  for (std::size_t j = 0; j < result_.terms.size(); ++j) {
    if (start_.held[j]) continue;
    ErrorTerm& term = result_.model.terms[j];
    result_.terms[j] = EstimateOf(j, term.magnitude);
    result_.terms[j].term = term.name;
    term.magnitude = result_.terms[j].magnitude;
  }
  result_.local = EstimateOf(result_.terms.size(), options_.local_sigma);
  std::size_t surveys = 0;
  for (std::size_t i = 0; i < result_.holes.size(); ++i) {
    result_.holes[i].chi_square = fit_.chi_square[i] / result_.holes[i].freedom;
    surveys += result_.holes[i].surveys;
  }
  result_.model.source =
      fmt::format("differences of {} surveys in {} holes; assumed before: {} ({})", surveys,
                  clusters_.size(), result_.model.name, result_.model.source);
  result_.model.name += " empirical";
  return std::move(result_);
}

}  // namespace

EmpiricalModel EstimateModel(std::span<const RepeatedHole> holes, const ErrorModel& assumed,
                             const EmpiricalOptions& options) {
  return Estimator(holes, assumed, options).Run();
}

}  // namespace wellgyro
