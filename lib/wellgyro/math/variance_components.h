#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// One independent source of scatter: what a draw of unit variance adds to rows from `first` on.
struct VarianceSource {
  std::optional<std::size_t> component;  ///< whose variance it has; absent: 1, known
  Eigen::Index first = 0;
  Eigen::VectorXd effect;
};

/// Data of one cluster, without a mean: y ~ N(0, V), V the sum over sources of variance times
/// effect effect'. Clusters are independent of each other. Where there were fixed effects, y and
/// the effects are contrasts free of them, and what is estimated is REML's.
struct VarianceCluster {
  Eigen::VectorXd y;
  /// First rows of cells, increasing from 0. Sources that stay within one cell are cheap, and those
  /// of each cell alone must make its rows' covariance regular.
  std::vector<Eigen::Index> cells;
  std::vector<VarianceSource> sources;
};

/// A variance; its interval is where twice the profile of the log-likelihood falls by no more than
/// the quantile of chi-square (Venzon and Moolgavkar, Applied Statistics 37, 1988).
struct VarianceEstimate {
  double value = 0;
  double lower = 0;
  std::optional<double> upper;  ///< absent: the data do not bound it
};

struct VarianceFit {
  std::vector<VarianceEstimate> components;
  std::vector<double> sigma;  ///< of each value, by the information at the maximum
  double log_likelihood = 0;  ///< but for a constant
  bool converged = false;
  std::vector<double> chi_square;  ///< y' V^-1 y of each cluster
};

/// Where a search begins, and which components stay there.
struct VarianceStart {
  std::vector<double> value;
  std::vector<bool> held;
};

/// Variances by maximum likelihood, none below 0, by Newton's steps with the average information
/// (Gilmour, Thompson and Cullis, Biometrics 51, 1995). `value` alone is filled.
///
/// O(rows x long^2) a cluster and step, long the sources of more than one cell. Throws
/// std::invalid_argument for sizes that do not fit, and where a cell is singular.
WELLGYRO_EXPORT VarianceFit FitVariances(std::span<const VarianceCluster> clusters,
                                         const VarianceStart& start);

/// Its components with their intervals, those held without.
WELLGYRO_EXPORT std::vector<VarianceEstimate> VarianceIntervals(
    std::span<const VarianceCluster> clusters, const VarianceStart& start, const VarianceFit& fit,
    double probability = 0.95);

/// Twice what the log-likelihood loses where component `which` is `value`.
WELLGYRO_EXPORT double VarianceDeviance(std::span<const VarianceCluster> clusters,
                                        const VarianceStart& start, const VarianceFit& fit,
                                        std::size_t which, double value);

}  // namespace wellgyro
