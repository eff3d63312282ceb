#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/fit/tool_minimise_internal.h"
#include "wellgyro/fit/tool_noise_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/median.h"

namespace wellgyro {
namespace {

std::array<double*, 5> SigmasOf(ToolNoise& noise) {
  return {&noise.accel, &noise.gyro, &noise.gyro_table, &noise.wobble, &noise.wobble_table};
}

}  // namespace

std::array<bool, NoiseFinder::kComponents> NoiseFinder::Held() const {
  return {setup_.sigma_accel.has_value(), setup_.sigma_gyro.has_value(),
          setup_.sigma_gyro_table.has_value(), setup_.sigma_wobble.has_value(),
          setup_.sigma_wobble.has_value()};
}

// Which of ToolNoise's the reading of one of the row's channels has.
std::size_t NoiseFinder::KindOf(const ToolRow& row, Eigen::Index place) const {
  const int channel = row.channels[static_cast<std::size_t>(place)];
  if (!readings_.channels[static_cast<std::size_t>(channel)].is_gyro) return 0;
  return row.mount >= 0 ? 2 : 1;
}

ToolNoise NoiseFinder::Start(const Eigen::VectorXd& x) {
  std::array<std::vector<double>, 3> sizes, readings;
  for (const ToolRow& row : readings_.rows) {
    const Eigen::VectorXd e = model_.At(row, x).v - row.v;
    for (Eigen::Index i = 0; i < e.size(); ++i) {
      sizes[KindOf(row, i)].push_back(std::abs(e[i]));
      readings[KindOf(row, i)].push_back(std::abs(row.v[i]));
    }
  }
  // Below that lies the rounding of what was written down, to eight digits at most.
  constexpr double kWrittenRounding = 1e-8;
  for (std::size_t kind = 0; kind < 3; ++kind) {
    floor_[kind] = std::max(kWrittenRounding * RobustSigma(readings[kind]), 1e-300);
  }
  ToolNoise noise;
  noise.wobble = noise.wobble_table = setup_.sigma_wobble.value_or(5e-5);
  noise.accel = setup_.sigma_accel.value_or(std::max(RobustSigma(sizes[0]), floor_[0]));
  noise.gyro = setup_.sigma_gyro.value_or(std::max(RobustSigma(sizes[1]), floor_[1]));
  noise.gyro_table = setup_.sigma_gyro_table.value_or(std::max(RobustSigma(sizes[2]), floor_[2]));
  return noise;
}

void NoiseFinder::Find(const std::vector<RowAbout>& rows, const Eigen::VectorXd& x, int sweeps,
                       ToolNoise& noise) const {
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const ToolNoise before = noise;
    Scale(SquaresOverExpected(rows, x, noise), noise);
    if (Alike(before, noise)) break;
  }
}

Eigen::VectorXd NoiseFinder::FindRobustly(std::vector<RowAbout> rows, const Eigen::VectorXd& x,
                                          ToolNoise& noise) const {
  // Bound: sweeps end where no sigma changes by 1 %; each changes one by five times at most.
  constexpr int kSweeps = 60;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(x.size());
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (RowAbout& row : rows) {
      const Eigen::MatrixXd W = model_.Whitener(*row.row, row.wobble, noise);
      const double n = static_cast<double>(row.e.size());
      row.weight = 5 * n / (4 * n + (W * (row.e - row.J * step)).squaredNorm());
    }
    const ToolNoise before = noise;
    Found found = SquaresOverExpected(rows, x, noise);
    step = std::move(found.step);
    Scale(found, noise);
    if (Alike(before, noise)) break;
  }
  return step;
}

std::array<double, 2> NoiseFinder::WobbleInformation(const std::vector<RowAbout>& rows,
                                                     const Eigen::VectorXd& x,
                                                     const ToolNoise& noise) const {
  return SquaresOverExpected(rows, x, noise).wobble_information;
}

void NoiseFinder::Scale(const Found& found, ToolNoise& noise) const {
  const std::array<bool, kComponents> held = Held();
  const std::array<double*, kComponents> sigmas = SigmasOf(noise);
  for (std::size_t k = 0; k < kComponents; ++k) {
    if (held[k] || !(found.ratios[k] > 0)) continue;
    const double factor = std::clamp(std::sqrt(found.ratios[k]), 0.2, 5.0);
    *sigmas[k] = std::max(*sigmas[k] * factor, floor_[k]);
  }
}

// Of each component with covariance V: y'P V P y over tr(P V), where P takes the parameters out
// (Patterson and Thompson 1971). At the likeliest sigmas all are one; 0 where there is nothing.
NoiseFinder::Found NoiseFinder::SquaresOverExpected(const std::vector<RowAbout>& rows,
                                                    const Eigen::VectorXd& x,
                                                    const ToolNoise& noise) const {
  const ToolPrior prior = PriorOfTool(model_);
  Eigen::MatrixXd N = prior.A.transpose() * prior.A;
  Eigen::VectorXd b = prior.A.transpose() * (prior.A * (prior.x0 - x));
  std::vector<Eigen::MatrixXd> precisions;
  for (const RowAbout& row : rows) {
    const Eigen::MatrixXd W = model_.Whitener(*row.row, row.wobble, noise);
    const Eigen::MatrixXd A = W * row.J;
    N.selfadjointView<Eigen::Lower>().rankUpdate(A.transpose(), row.weight);
    b += row.weight * (A.transpose() * (W * row.e));
    precisions.push_back(W.transpose() * W);
  }
  const Eigen::VectorXd scale = N.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled =
      scale.asDiagonal() * Eigen::MatrixXd(N.selfadjointView<Eigen::Lower>()) * scale.asDiagonal();
  const Eigen::MatrixXd cov = scale.asDiagonal() * InverseOfSymmetric(scaled) * scale.asDiagonal();
  Found found;
  found.step = cov * b;
  std::array<double, kComponents> squares{}, expected{};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RowAbout& row = rows[i];
    const Eigen::VectorXd r = precisions[i] * (row.e - row.J * found.step);
    const Eigen::MatrixXd WJ = precisions[i] * row.J;
    const Eigen::MatrixXd P = precisions[i] - row.weight * (WJ * cov * WJ.transpose());
    for (Eigen::Index c = 0; c < r.size(); ++c) {
      squares[KindOf(*row.row, c)] += row.weight * r[c] * r[c];
      expected[KindOf(*row.row, c)] += P(c, c);
    }
    const std::size_t turning = row.row->mount >= 0 ? 1 : 0;
    squares[3 + turning] += row.weight * (row.wobble.transpose() * r).squaredNorm();
    const Eigen::Matrix3d of_wobble = row.wobble.transpose() * P * row.wobble;
    expected[3 + turning] += of_wobble.trace();
    found.wobble_information[turning] += of_wobble.squaredNorm() / 2;
  }
  for (std::size_t k = 0; k < kComponents; ++k) {
    if (expected[k] > 0) found.ratios[k] = squares[k] / expected[k];
  }
  return found;
}

}  // namespace wellgyro
