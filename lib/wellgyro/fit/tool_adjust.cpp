#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "wellgyro/fit/tool_adjust_internal.h"
#include "wellgyro/fit/tool_minimise_internal.h"
#include "wellgyro/fit/tool_observability_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/median.h"

namespace wellgyro {
namespace {

double RobustSigma(std::vector<double> sizes) {
  return kSigmaPerMedianSize * Median(std::move(sizes));
}

// Which of ToolNoise's a channel's reading has.
int KindOf(const ToolReadings& readings, const ToolRow& row, int channel) {
  if (!readings.channels[static_cast<std::size_t>(channel)].is_gyro) return 0;
  return row.mount >= 0 ? 2 : 1;
}

class Adjuster {
 public:
  Adjuster(const ToolReadings& readings, const ToolFitSetup& setup, const ToolModel& model)
      : readings_(readings), setup_(setup), model_(model), out_(readings.rows.size(), 0) {}

  Result<ToolAdjustment> Adjust() {
    Start();
    if (!x_.allFinite()) return Unsettled();
    for (int turn = 0; turn < kRobustTurns; ++turn) {
      if (!Minimise(true)) return Unsettled();
      const std::vector<char> before = out_;
      // The start's sigmas weigh the kinds of readings badly against each other.
      if (turn > 0) MarkOutliers();
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
  // Of noise: three kinds of readings, the wobble of attitudes and of the rate table.
  static constexpr std::size_t kComponents = 5;
  static constexpr int kRobustTurns = 6, kTurns = 6, kRoughSweeps = 3, kSweeps = 12;

  static Fault Unsettled() {
    return {.code = FaultCode::kRange,
            .text =
                "the adjustment does not settle, the readings do not fit the model: look for wrong "
                "signs, exchanged columns, mixed units or a wrong reference"};
  }

  std::array<double*, kComponents> Components() {
    return {&noise_.accel, &noise_.gyro, &noise_.gyro_table, &noise_.wobble, &noise_.wobble_table};
  }
  std::array<bool, kComponents> Held() const {
    return {setup_.sigma_accel.has_value(), setup_.sigma_gyro.has_value(),
            setup_.sigma_gyro_table.has_value(), setup_.sigma_wobble.has_value(),
            setup_.sigma_wobble.has_value()};
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
    std::array<std::vector<double>, 3> sizes, readings;
    for (const ToolRow& row : readings_.rows) {
      const Eigen::VectorXd e = model_.At(row, x_).v - row.v;
      for (Eigen::Index i = 0; i < e.size(); ++i) {
        const auto kind = static_cast<std::size_t>(
            KindOf(readings_, row, row.channels[static_cast<std::size_t>(i)]));
        sizes[kind].push_back(std::abs(e[i]));
        readings[kind].push_back(std::abs(row.v[i]));
      }
    }
    // Below that lies the rounding of what was written down.
    constexpr double kWrittenRounding = 1e-8;
    for (std::size_t kind = 0; kind < 3; ++kind) {
      floor_[kind] = std::max(kWrittenRounding * RobustSigma(readings[kind]), 1e-300);
    }
    noise_.wobble = noise_.wobble_table = setup_.sigma_wobble.value_or(5e-5);
    noise_.accel = setup_.sigma_accel.value_or(std::max(RobustSigma(sizes[0]), floor_[0]));
    noise_.gyro = setup_.sigma_gyro.value_or(std::max(RobustSigma(sizes[1]), floor_[1]));
    noise_.gyro_table =
        setup_.sigma_gyro_table.value_or(std::max(RobustSigma(sizes[2]), floor_[2]));
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

  // Rows with a reading beyond the limit, in units of what the others scatter by.
  void MarkOutliers() {
    std::vector<double> largest, all;
    for (const ToolRow& row : readings_.rows) {
      const Eigen::VectorXd r = WhitenerOf(row) * (model_.At(row, x_).v - row.v);
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

  // A row about x: its residual, and by what it changes.
  struct Left {
    const ToolRow* row;
    Eigen::VectorXd e;
    Eigen::MatrixXd J, wobble;
  };

  std::vector<Left> RowsLeft() const {
    std::vector<Left> rows;
    for (std::size_t i = 0; i < readings_.rows.size(); ++i) {
      if (out_[i] != 0) continue;
      const ToolRow& row = readings_.rows[i];
      ToolModel::Prediction at = model_.At(row, x_);
      rows.push_back({&row, row.v - at.v, std::move(at.J), std::move(at.wobble)});
    }
    return rows;
  }

  // The sigmas under which what is left is likeliest, what each kind of readings loses to the
  // parameters allowed for (restricted likelihood), in a model linear about x.
  void FindNoise(int sweeps) {
    const std::vector<Left> rows = RowsLeft();
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      const ToolNoise before = noise_;
      const std::array<double, kComponents> ratios = SquaresOverExpected(rows).ratios;
      const std::array<bool, kComponents> held = Held();
      const std::array<double*, kComponents> sigmas = Components();
      for (std::size_t k = 0; k < kComponents; ++k) {
        if (held[k] || !(ratios[k] > 0)) continue;
        const double factor = std::clamp(std::sqrt(ratios[k]), 0.2, 5.0);
        *sigmas[k] = std::max(*sigmas[k] * factor, floor_[k]);
      }
      if (Alike(before, noise_)) break;
    }
  }

  // Of each component with covariance V: y'P V P y over tr(P V), where P takes the parameters out
  // (Patterson and Thompson 1971). At the likeliest sigmas all are one; 0 where there is nothing.
  // The information on a wobble's variance is tr(V P V P) / 2, row by row.
  struct NoiseFound {
    std::array<double, kComponents> ratios{};
    std::array<double, 2> wobble_information{};
  };
  NoiseFound SquaresOverExpected(const std::vector<Left>& rows) const {
    const ToolPrior prior = PriorOfTool(model_);
    Eigen::MatrixXd N = prior.A.transpose() * prior.A;
    Eigen::VectorXd b = prior.A.transpose() * (prior.A * (prior.x0 - x_));
    std::vector<Eigen::MatrixXd> weights;
    for (const Left& left : rows) {
      const Eigen::MatrixXd W = model_.Whitener(*left.row, left.wobble, noise_);
      const Eigen::MatrixXd A = W * left.J;
      N.selfadjointView<Eigen::Lower>().rankUpdate(A.transpose());
      b += A.transpose() * (W * left.e);
      weights.push_back(W.transpose() * W);
    }
    const Eigen::VectorXd scale = N.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() *
                                   Eigen::MatrixXd(N.selfadjointView<Eigen::Lower>()) *
                                   scale.asDiagonal();
    const Eigen::MatrixXd cov =
        scale.asDiagonal() * InverseOfSymmetric(scaled) * scale.asDiagonal();
    const Eigen::VectorXd step = cov * b;
    NoiseFound found;
    std::array<double, kComponents> squares{}, expected{};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Left& left = rows[i];
      const Eigen::VectorXd r = weights[i] * (left.e - left.J * step);
      const Eigen::MatrixXd WJ = weights[i] * left.J;
      const Eigen::MatrixXd P = weights[i] - WJ * cov * WJ.transpose();
      for (Eigen::Index c = 0; c < r.size(); ++c) {
        const auto kind = static_cast<std::size_t>(
            KindOf(readings_, *left.row, left.row->channels[static_cast<std::size_t>(c)]));
        squares[kind] += r[c] * r[c];
        expected[kind] += P(c, c);
      }
      const std::size_t turning = left.row->mount >= 0 ? 1 : 0;
      squares[3 + turning] += (left.wobble.transpose() * r).squaredNorm();
      const Eigen::Matrix3d of_wobble = left.wobble.transpose() * P * left.wobble;
      expected[3 + turning] += of_wobble.trace();
      found.wobble_information[turning] += of_wobble.squaredNorm() / 2;
    }
    for (std::size_t k = 0; k < kComponents; ++k) {
      if (expected[k] > 0) found.ratios[k] = squares[k] / expected[k];
    }
    return found;
  }

  // Linear about x, with the priors as rows of line 0.
  LinearProblem Linearise() const {
    Eigen::Index n = 0;
    for (std::size_t i = 0; i < readings_.rows.size(); ++i) {
      if (out_[i] == 0) n += static_cast<Eigen::Index>(readings_.rows[i].channels.size());
    }
    const ToolPrior prior = PriorOfTool(model_);
    LinearProblem linear(model_.names(), static_cast<int>(n + prior.A.rows()));
    linear.sigma_given = true;
    linear.robust = false;
    Eigen::Index at = 0;
    for (std::size_t i = 0; i < readings_.rows.size(); ++i) {
      if (out_[i] != 0) continue;
      const ToolRow& row = readings_.rows[i];
      const ToolModel::Prediction p = model_.At(row, x_);
      const Eigen::MatrixXd W = model_.Whitener(row, p.wobble, noise_);
      const auto size = static_cast<Eigen::Index>(row.channels.size());
      linear.A.middleRows(at, size) = W * p.J;
      linear.y.segment(at, size) = W * (p.J * x_ + row.v - p.v);
      for (Eigen::Index k = 0; k < size; ++k) {
        const int channel = row.channels[static_cast<std::size_t>(k)];
        linear.rows[static_cast<std::size_t>(at + k)] = {
            static_cast<int>(i) + 1,
            (row.mount >= 0 ? "table " : "") +
                readings_.channels[static_cast<std::size_t>(channel)].name,
            1 / W(k, k), true, W.col(k)};
      }
      at += size;
    }
    linear.A.bottomRows(prior.A.rows()) = prior.A;
    linear.y.tail(prior.A.rows()) = prior.A * prior.x0;
    return linear;
  }

  // By normal equations of scaled columns: the terms that are there are told apart well.
  Result<ToolAdjustment> Finish() const {
    ToolAdjustment a{x_, {}, noise_, out_, Linearise(), {}};
    const std::array<double, 2> information = SquaresOverExpected(RowsLeft()).wobble_information;
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
      return Undetermined(model_.names(), eigen.vectors.col(0));
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
  Eigen::VectorXd x_;
  ToolNoise noise_;
  std::array<double, kComponents> floor_{1e-300, 1e-300, 1e-300, 1e-8, 1e-8};
  std::vector<char> out_;
};

}  // namespace

Result<ToolAdjustment> AdjustTool(const ToolReadings& readings, const ToolFitSetup& setup,
                                  const std::vector<ToolTerm>& terms) {
  const ToolModel model(readings, setup, terms);
  return Adjuster(readings, setup, model).Adjust();
}

}  // namespace wellgyro
