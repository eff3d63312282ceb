#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/tool_adjust_internal.h"
#include "wellgyro/fit/tool_minimise_internal.h"
#include "wellgyro/fit/tool_noise_internal.h"
#include "wellgyro/fit/tool_observability_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/median.h"

namespace wellgyro {
namespace {

class Adjuster {
 public:
  Adjuster(const ToolReadings& readings, const ToolFitSetup& setup, const ToolModel& model)
      : readings_(readings),
        setup_(setup),
        model_(model),
        finder_(readings, setup, model),
        out_(readings.rows.size(), 0) {}

  Result<ToolAdjustment> Adjust() {
    Start();
    if (!x_.allFinite()) return Unsettled();
    for (int turn = 0; turn < kRobustTurns; ++turn) {
      if (!Minimise(true)) return Unsettled();
      const std::vector<char> before = out_;
      MarkOutliers();
      FindNoise(kRoughSweeps);
      if (turn > 1 && before == out_) break;
    }
    for (int turn = 0; turn < kTurns; ++turn) {
      if (!Minimise(false)) return Unsettled();
      const ToolNoise before = noise_;
      FindNoise(kSweeps);
      if (Alike(before, noise_)) break;
    }
    return Finish();
  }

 private:
  // Bounds, for outliers and sigmas that go to and fro: turns and sweeps end where none changes (by
  // 1 %). Few sweeps while outliers are sought: the next turn goes on with what these found.
  static constexpr int kRobustTurns = 6, kTurns = 6, kRoughSweeps = 3, kSweeps = 12;

  static Fault Unsettled() {
    return {.code = FaultCode::kRange,
            .text =
                "the adjustment does not settle, the readings do not fit the model: look for wrong "
                "signs, exchanged columns, mixed units or a wrong reference"};
  }

  // The coefficients by plain least squares, channel kinds weighed alike; then their scatter.
  void Start() {
    const Eigen::Index n = model_.n_terms();
    x_ = Eigen::VectorXd::Zero(model_.size());
    Eigen::MatrixXd N = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
    for (const ToolRow& row : readings_.rows) {
      const ToolModel::Prediction at = model_.At(row, x_);
      const auto A = at.J.leftCols(n);
      N += A.transpose() * A;
      b += A.transpose() * row.v;
    }
    const Eigen::VectorXd scale = N.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * N * scale.asDiagonal();
    x_.head(n) = scale.cwiseProduct(Eigen::VectorXd(SolveLeastNorm(scaled, scale.cwiseProduct(b))));
    noise_ = robust_noise_ = finder_.Start(x_);
  }

  Eigen::MatrixXd WhitenerOf(const ToolRow& row) const {
    return model_.Whitener(row, model_.At(row, x_).wobble, noise_);
  }

  bool Minimise(bool robust) {
    std::vector<WhitenedRow> rows;
    for (std::size_t i = 0; i < readings_.rows.size(); ++i) {
      if (!robust && out_[i] != 0) continue;
      rows.push_back({&readings_.rows[i], WhitenerOf(readings_.rows[i])});
    }
    return MinimiseTool(model_, rows, robust, x_);
  }

  // Rows with a reading beyond the limit, in units of what the others scatter by: about
  // coefficients and by sigmas that no few rows move, whatever the start made of them.
  void MarkOutliers() {
    const std::vector<RowAbout> rows = RowsAbout(std::vector<char>(out_.size(), 0));
    const Eigen::VectorXd step = finder_.FindRobustly(rows, x_, robust_noise_);
    std::vector<double> largest, all;
    for (const RowAbout& row : rows) {
      const Eigen::VectorXd r =
          model_.Whitener(*row.row, row.wobble, robust_noise_) * (row.e - row.J * step);
      largest.push_back(r.cwiseAbs().maxCoeff());
      for (const double value : r) all.push_back(std::abs(value));
    }
    const double n = static_cast<double>(all.size());
    const double freedom = std::max(1.0, n - model_.n_terms());
    const double scale = RobustSigma(all) * std::sqrt(n / freedom);
    std::size_t count = 0;
    for (std::size_t i = 0; i < out_.size(); ++i) {
      out_[i] = largest[i] > kOutlierSigmas * scale ? 1 : 0;
      count += out_[i] != 0 ? 1 : 0;
    }
    if (4 * count > out_.size()) std::fill(out_.begin(), out_.end(), 0);
  }

  std::vector<RowAbout> RowsAbout(const std::vector<char>& without) const {
    std::vector<RowAbout> rows;
    for (std::size_t i = 0; i < readings_.rows.size(); ++i) {
      if (without[i] != 0) continue;
      const ToolRow& row = readings_.rows[i];
      ToolModel::Prediction at = model_.At(row, x_);
      rows.push_back({&row, row.v - at.v, std::move(at.J), std::move(at.wobble)});
    }
    return rows;
  }

  void FindNoise(int sweeps) { finder_.Find(RowsAbout(out_), x_, sweeps, noise_); }

  // What readings at rest determine is lost beside a rate table's where one fit, which follows the
  // table, leaves them hundreds of times coarser than gyros are that find north.
  bool Contradict() const {
    constexpr double kCoarse = kCoarseShare * kBenchEarthDegPerHour;  // as DoesNotFit()
    return noise_.gyro > kCoarse && noise_.gyro > noise_.gyro_table;
  }
  Fault Contradiction() const {
    return {
        .code = FaultCode::kConflict,
        .text = fmt::format(
            "the gyros' readings at rest scatter by {:.2g} deg/h and the rate table's by {:.2g} "
            "about the fit of both: they contradict each other, look for other units, wrong "
            "signs, exchanged columns or axes of the rate table",
            noise_.gyro, noise_.gyro_table)};
  }

  // By normal equations of scaled columns: the terms that are there are told apart well.
  Result<ToolAdjustment> Finish() const {
    ToolAdjustment a{x_, {}, noise_, out_, LineariseTool(readings_, model_, noise_, out_, x_), {}};
    const std::array<double, 2> information =
        finder_.WobbleInformation(RowsAbout(out_), x_, noise_);
    for (std::size_t k = 0; k < 2 && !setup_.sigma_wobble; ++k) {
      if (information[k] > 0) a.sigma_wobble_square[k] = 1 / std::sqrt(information[k]);
    }
    const Eigen::MatrixXd& A = a.linear.A;
    const Eigen::VectorXd scale = A.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
    const Eigen::MatrixXd scaled = A * scale.asDiagonal();
    const Eigen::MatrixXd N = scaled.transpose() * scaled;
    const SymmetricEigen eigen = EigenOfSymmetric(N);
    const Eigen::VectorXd& values = eigen.values;
    if (!(values[0] > 1e-13 * values[values.size() - 1])) {
      return Contradict() ? Contradiction() : Undetermined(model_.names(), eigen.vectors.col(0));
    }
    const Eigen::MatrixXd inverse =
        eigen.vectors * values.cwiseInverse().asDiagonal() * eigen.vectors.transpose();
    a.cov = scale.asDiagonal() * inverse * scale.asDiagonal();
    LinearSolution& s = a.solution;
    s.x = x_;
    s.cov = a.cov;
    s.residual = a.linear.y - A * x_;
    s.leverage = (scaled * inverse).cwiseProduct(scaled).rowwise().sum();
    s.rows = a.linear.rows;
    s.rank = model_.size();
    s.condition = std::sqrt(values[values.size() - 1] / values[0]);
    s.chi_square = s.residual.squaredNorm();
    s.dof = static_cast<int>(A.rows()) - model_.size();
    return a;
  }

  const ToolReadings& readings_;
  const ToolFitSetup& setup_;
  const ToolModel& model_;
  NoiseFinder finder_;
  Eigen::VectorXd x_;
  ToolNoise noise_, robust_noise_;
  std::vector<char> out_;
};

}  // namespace

LinearProblem LineariseTool(const ToolReadings& readings, const ToolModel& model,
                            const ToolNoise& noise, const std::vector<char>& out,
                            const Eigen::VectorXd& x) {
  Eigen::Index n = 0;
  for (std::size_t i = 0; i < readings.rows.size(); ++i) {
    if (out[i] == 0) n += static_cast<Eigen::Index>(readings.rows[i].channels.size());
  }
  const ToolPrior prior = PriorOfTool(model);
  LinearProblem linear(model.names(), static_cast<int>(n + prior.A.rows()));
  linear.sigma_given = true;
  linear.robust = false;
  Eigen::Index at = 0;
  for (std::size_t i = 0; i < readings.rows.size(); ++i) {
    if (out[i] != 0) continue;
    const ToolRow& row = readings.rows[i];
    const ToolModel::Prediction p = model.At(row, x);
    const Eigen::MatrixXd W = model.Whitener(row, p.wobble, noise);
    const auto size = static_cast<Eigen::Index>(row.channels.size());
    linear.A.middleRows(at, size) = W * p.J;
    linear.y.segment(at, size) = W * (p.J * x + row.v - p.v);
    for (Eigen::Index k = 0; k < size; ++k) {
      const int channel = row.channels[static_cast<std::size_t>(k)];
      linear.rows[static_cast<std::size_t>(at + k)] = {
          static_cast<int>(i) + 1,
          (row.mount >= 0 ? "table " : "") +
              readings.channels[static_cast<std::size_t>(channel)].name,
          1 / W(k, k), true, W.col(k)};
    }
    at += size;
  }
  linear.A.bottomRows(prior.A.rows()) = prior.A;
  linear.y.tail(prior.A.rows()) = prior.A * prior.x0;
  return linear;
}

Result<ToolAdjustment> AdjustTool(const ToolReadings& readings, const ToolFitSetup& setup,
                                  const std::vector<ToolTerm>& terms) {
  const ToolModel model(readings, setup, terms);
  return Adjuster(readings, setup, model).Adjust();
}

}  // namespace wellgyro
