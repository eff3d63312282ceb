#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/math/random.h"
#include "wellgyro/noise/allan_variance.h"
#include "wellgyro/noise/noise_model.h"
#include "wellgyro/noise/variance_fit_internal.h"

namespace wellgyro {

/// The averaging times of a fit, and what models say about them.
struct OctaveGrid {
  double period = 0;
  std::vector<std::int64_t> factors;
  std::vector<std::int64_t> terms;

  Eigen::Index size() const { return static_cast<Eigen::Index>(factors.size()); }
  double tau(Eigen::Index i) const {
    return static_cast<double>(factors[static_cast<std::size_t>(i)]) * period;
  }
  /// Unit variances of all terms, one column each.
  Eigen::MatrixXd Columns(const NoiseShape& shape) const;
  Eigen::VectorXd Dof(const NoiseModel& model) const;
};

NoiseModel ModelOf(const TermVector& weight, const NoiseShape& shape);

/// Draws tables of sample variances as logs of a model's noise would give them: chi-square each,
/// joined by a normal copula with the correlations of the overlapped estimator.
class TableSampler {
 public:
  TableSampler(const OctaveGrid& grid, const NoiseModel& model);
  Eigen::VectorXd Draw(Random& random) const;
  const Eigen::VectorXd& dof() const { return dof_; }

 private:
  Eigen::VectorXd mean_;
  Eigen::VectorXd dof_;
  Eigen::MatrixXd root_;
};

}  // namespace wellgyro
