#include <algorithm>
#include <utility>

#include "wellgyro/uncertainty/error_sources_internal.h"

namespace wellgyro {

using Eigen::Matrix3d;

std::size_t ErrorSources::SourceOf(const ErrorTerm& term, const ToolLeg& leg,
                                   std::size_t leg_number) {
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
  source.leg = leg_number;
  source.run = leg.run;
  source.model = leg.model;
  sources_.push_back(std::move(source));
  return sources_.size() - 1;
}

void ErrorSources::Open(std::size_t stations, PositionUncertainty& result) {
  result.cov_p_W.reserve(stations);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& source = sources_[i];
    if (source.propagation == Propagation::kWell || source.propagation == Propagation::kGlobal) {
      shared_.push_back(i);
      result.shared.push_back({source.name, source.propagation, {}});
      result.shared.back().error_p_W.reserve(stations);
    }
    if (!options_.terms) continue;
    const auto same = [&](const Source& s) { return s.name == source.name; };
    const bool alone = std::ranges::count_if(sources_, same) == 1;
    result.terms.push_back(
        {alone ? source.name : source.name + "/" + std::to_string(source.leg + 1), {}});
    result.terms.back().cov_p_W.reserve(stations);
  }
}

void ErrorSources::StartLeg(const std::vector<std::size_t>& sources) {
  active_.clear();
  for (const std::size_t i : sources) {
    if (std::ranges::find(active_, i) == active_.end()) active_.push_back(i);
  }
  resting_.clear();
  cov_idle_W_ = cov_tie_in_W_;
  std::vector<bool> is_active(sources_.size(), false);
  for (const std::size_t i : active_) is_active[i] = true;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    if (is_active[i]) continue;
    resting_.push_back(i);
    Source& source = sources_[i];
    source.error_W = source.sum_W;
    cov_idle_W_ += source.sum_W * source.sum_W.transpose();
  }
}

void ErrorSources::Close(Source& source, std::int64_t group) {
  const Matrix3d cov = source.sum_W * source.sum_W.transpose();
  cov_ended_W_ += cov;
  if (options_.terms) {
    source.cov_closed_W += cov;
    source.has_closed = true;
  }
  source.sum_W.setZero();
  source.group = group;
}

void ErrorSources::Forget() {
  cov_tie_in_W_.setZero();
  cov_ended_W_.setZero();
  cov_idle_W_.setZero();
  for (Source& source : sources_) {
    source.sum_W.setZero();
    source.error_W.setZero();
    source.cov_closed_W.setZero();
    source.has_closed = false;
  }
}

void ErrorSources::Give(PositionUncertainty& result) const {
  Matrix3d total = cov_ended_W_ + cov_idle_W_;
  for (const std::size_t i : active_) {
    const Source& s = sources_[i];
    const Matrix3d own = s.error_W * s.error_W.transpose();
    total += own;
    if (!options_.terms) continue;
    std::vector<Matrix3d>& term = result.terms[i].cov_p_W;
    if (s.has_closed) {
      term.push_back(s.cov_closed_W + own);
    } else {
      term.push_back(own);
    }
  }
  result.cov_p_W.push_back(total);
  for (std::size_t i = 0; i < shared_.size(); ++i) {
    result.shared[i].error_p_W.push_back(sources_[shared_[i]].error_W);
  }
  if (!options_.terms) return;
  for (const std::size_t i : resting_) {
    const Source& s = sources_[i];
    result.terms[i].cov_p_W.push_back(s.cov_closed_W + s.error_W * s.error_W.transpose());
  }
}

}  // namespace wellgyro
