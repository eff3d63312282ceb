#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include <ceres/ceres.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/fit/adjust_cost_internal.h"
#include "wellgyro/fit/adjust_problem_internal.h"

namespace wellgyro {
namespace {

constexpr int kIterationsMax = 400;   // two hundred where a sliding tool passes through vertical
constexpr double kNothingKnown = 10;  // sigma of an azimuth [rad]

bool Used(const FilterFix& f) { return f.use == FixUse::kUsed || f.use == FixUse::kMirror; }

// The node at the end of each epoch that ends a span.
std::optional<std::size_t> NodeAt(const AdjustProblem& p, std::size_t epoch) {
  const auto after = std::lower_bound(
      p.spans.begin(), p.spans.end(), epoch + 1,
      [](const AdjustSpan& span, std::size_t end) { return span.epoch_end < end; });
  if (after == p.spans.end() || after->epoch_end != epoch + 1) return std::nullopt;
  return static_cast<std::size_t>(after - p.spans.begin()) + 1;
}

class Builder {
 public:
  explicit Builder(AdjustProblem* p) : p_(*p) {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    problem_ = std::make_unique<ceres::Problem>(options);
    loss_ = std::make_unique<ceres::HuberLoss>(p_.huber);
    for (std::size_t k = 0; k < p_.node_count(); ++k) {
      problem_->AddParameterBlock(p_.node(k), p_.layout.node);
    }
    problem_->AddParameterBlock(p_.common.data(), p_.layout.common);
    AddSpans();
    AddAzimuths();
    for (const AdjustProblem::Repeat& r : p_.repeats) {
      Add(RepeatCost(p_.layout, {r.sigma_azimuth, r.sigma_inclination, r.sine}), RunFit::kRepeat,
          {p_.node(r.first), p_.node(r.second), p_.common.data()});
    }
    if (p_.layout.drift() > 0) Add(DriftPriorCost(p_.layout), RunFit::kParts, {p_.node(0)});
    Add(CommonPriorCost(p_.layout), RunFit::kParts, {p_.common.data()});
  }

  ceres::Problem& problem() { return *problem_; }
  /// Of every residual.
  const std::vector<RunFit::Part>& parts() const { return parts_; }

 private:
  // Growth between nodes and priors belong to no part, and count in full.
  void Add(std::unique_ptr<ceres::CostFunction> cost, RunFit::Part part,
           const std::vector<double*>& blocks) {
    parts_.insert(parts_.end(), static_cast<std::size_t>(cost->num_residuals()), part);
    problem_->AddResidualBlock(cost.release(), part == RunFit::kParts ? nullptr : loss_.get(),
                               blocks);
  }

  void AddSpans() {
    for (std::size_t k = 0; k < p_.spans.size(); ++k) {
      const AdjustSpan& span = p_.spans[k];
      const std::vector<double*> blocks{p_.node(k), p_.node(k + 1), p_.common.data()};
      const std::size_t first = parts_.size();
      Add(SpanCost(p_.layout, span), RunFit::kParts, blocks);
      if (!span.still && !span.broken && (!span.vertical || span.lifts)) {
        parts_[first + AdjustLayout::kInclination] = RunFit::kInclination;
      }
      if (span.still && !span.vertical) Add(StillCost(p_.layout, span), RunFit::kRest, blocks);
      if (span.levelled) Add(LevelCost(p_.layout, span), RunFit::kInclination, blocks);
    }
  }

  void AddAzimuths() {
    const FilterSetup& setup = p_.history->setup;
    if (setup.start_azimuth) {
      Add(AzimuthCost(p_.layout, *setup.start_azimuth, setup.start_sigma), RunFit::kParts,
          {p_.node(0)});
    } else {  // a matrix that can be inverted even if nothing ever tells
      Add(AzimuthCost(p_.layout, p_.azimuth(0), kNothingKnown), RunFit::kParts, {p_.node(0)});
    }
    for (const AdjustProblem::Hold& hold : p_.holds) {
      const auto node = NodeAt(p_, hold.epoch);
      if (!node) continue;
      Add(AzimuthCost(p_.layout, hold.azimuth, hold.sigma), RunFit::kParts, {p_.node(*node)});
    }
    for (const FilterFix& f : p_.history->fixes) {
      if (!Used(f) || f.rates) continue;
      std::size_t node = 0;
      double since = 0;
      if (f.epoch_end > 0) {
        const auto found = NodeAt(p_, f.epoch_end - 1);
        if (!found) continue;
        node = *found;
        const Knot& knot = p_.history->epochs[f.epoch_end - 1].knot;
        const double after = (knot.time - f.fix.end).seconds() / knot.seconds;
        if (!knot.still) since = knot.turn * std::clamp(after, 0.0, 1.0);
      }
      Add(AzimuthCost(p_.layout, f.azimuth + since, std::sqrt(f.fix.cov_attitude(1, 1))),
          RunFit::kAzimuth, {p_.node(node)});
    }
  }

  AdjustProblem& p_;
  std::vector<RunFit::Part> parts_;
  std::unique_ptr<ceres::LossFunction> loss_;
  std::unique_ptr<ceres::Problem> problem_;
};

// Without rows where some residual has no value.
AdjustRows RowsAt(const AdjustProblem& p, Builder& builder) {
  ceres::Problem::EvaluateOptions options;
  for (std::size_t k = 0; k < p.node_count(); ++k) {
    options.parameter_blocks.push_back(const_cast<double*>(p.node(k)));
  }
  options.parameter_blocks.push_back(const_cast<double*>(p.common.data()));
  ceres::CRSMatrix crs;
  AdjustRows rows;
  if (!builder.problem().Evaluate(options, nullptr, &rows.residual, nullptr, &crs)) return {};
  rows.jacobian = Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>>(
      crs.num_rows, crs.num_cols, static_cast<Eigen::Index>(crs.values.size()), crs.rows.data(),
      crs.cols.data(), crs.values.data());
  rows.part = builder.parts();
  return rows;
}

}  // namespace

void StartFrom(const std::vector<double>& azimuths, AdjustProblem* p) {
  p->nodes.assign(p->node_count() * static_cast<std::size_t>(p->layout.node), 0.0);
  p->common.assign(static_cast<std::size_t>(p->layout.common), 0.0);
  const auto& epochs = p->history->epochs;
  for (std::size_t k = 0; k < p->node_count(); ++k) {
    double inclination = 0;
    if (k > 0) {
      inclination = epochs[p->spans[k - 1].epoch_end - 1].knot.inclination;
    } else {
      const AdjustSpan& first = p->spans.front();
      inclination = epochs[first.epoch_end - 1].knot.inclination - first.lift;
    }
    p->node(k)[AdjustLayout::kAzimuth] = azimuths[k];
    p->node(k)[AdjustLayout::kInclination] = inclination;
  }
}

AdjustOutcome Solve(AdjustProblem* p, AdjustRows* rows) {
  Builder builder(p);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = kIterationsMax;
  options.num_threads = 1;
  options.initial_trust_region_radius = 1e8;
  options.use_nonmonotonic_steps = true;  // along valleys that the Earth bends near vertical
  options.function_tolerance = 1e-9;
  options.parameter_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &builder.problem(), &summary);
  bool converged = summary.termination_type == ceres::CONVERGENCE;
  if (rows != nullptr) {
    *rows = RowsAt(*p, builder);
    converged = converged && !rows->residual.empty();
  }
  return {2 * summary.final_cost, summary.num_residuals,
          static_cast<int>(summary.iterations.size()), converged};
}

}  // namespace wellgyro
