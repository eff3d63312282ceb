#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/noise/allan_confidence.h"
#include "wellgyro/noise/octave_table_internal.h"

namespace wellgyro {
namespace {

// Chi-square over its degrees of freedom at the quantile of a standard normal.
double ScaledChiSquare(double z, double dof) {
  constexpr double kWilsonHilfertyFrom = 300;  // good to 1e-5 there
  if (dof > kWilsonHilfertyFrom) {
    const double w = 2 / (9 * dof);
    return std::pow(1 - w + z * std::sqrt(w), 3);
  }
  const double p = std::clamp(NormalCdf(z), 1e-12, 1 - 1e-12);
  return ChiSquareQuantile(p, dof) / dof;
}

}  // namespace

Eigen::MatrixXd OctaveGrid::Columns(const NoiseShape& shape) const {
  Eigen::MatrixXd columns(size(), static_cast<Eigen::Index>(kNoiseTerms));
  for (Eigen::Index i = 0; i < size(); ++i) {
    for (const auto term : kAllNoiseTerms) {
      columns(i, static_cast<Eigen::Index>(term)) = UnitAllanVariance(term, shape, tau(i));
    }
  }
  return columns;
}

Eigen::VectorXd OctaveGrid::Dof(const NoiseModel& model) const {
  Eigen::VectorXd dof(size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    dof(i) = EquivalentDof(model, period, factors[at], terms[at], Deviation::kOverlapped);
  }
  return dof;
}

NoiseModel ModelOf(const TermVector& weight, const NoiseShape& shape) {
  NoiseModel model;
  model.shape = shape;
  for (const auto term : kAllNoiseTerms) {
    model.coefficient[term] = std::sqrt(std::max(0., weight(static_cast<Eigen::Index>(term))));
  }
  return model;
}

TableSampler::TableSampler(const OctaveGrid& grid, const NoiseModel& model)
    : mean_(grid.size()), dof_(grid.Dof(model)) {
  for (Eigen::Index i = 0; i < grid.size(); ++i) mean_(i) = ModelAllanVariance(model, grid.tau(i));
  Eigen::MatrixXd correlation = OctaveCovariance(model, grid.period, grid.factors, grid.terms);
  const Eigen::VectorXd sigma = correlation.diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < grid.size(); ++i) {
    for (Eigen::Index j = 0; j < grid.size(); ++j) correlation(i, j) /= sigma(i) * sigma(j);
  }
  // Correlations left out far from the diagonal may cost it a hair of definiteness.
  double jitter = 1e-9;
  Cholesky root;
  do {
    correlation.diagonal().array() += jitter;
    root = Cholesky(correlation);
    jitter *= 10;
  } while (!root.positive());
  root_ = root.L();
}

Eigen::VectorXd TableSampler::Draw(Random& random) const {
  Eigen::VectorXd z(mean_.size());
  for (double& value : z) value = random.Normal();
  z = root_ * z;
  for (Eigen::Index i = 0; i < z.size(); ++i) z(i) = mean_(i) * ScaledChiSquare(z(i), dof_(i));
  return z;
}

}  // namespace wellgyro
