#pragma once

#include <vector>

#include <Eigen/Core>

#include "wellgyro/fit/tool_adjust_internal.h"

namespace wellgyro {

/// What leaving terms out does to a calibration.
struct LeftOutErrors {
  std::vector<ToolTerm> terms;  ///< that the readings could tell, and were not kept
  /// Of the kept parameters and, behind them, of these coefficients: to be added to the adjustment
  /// without them, where they are zero; and the covariance of the errors then, beside what the
  /// readings' noise does.
  Eigen::VectorXd shift;
  Eigen::MatrixXd cov;
};

/// A coefficient theta that is left out moves the kept parameters by K theta, K = N_kk^-1 N_kl of
/// the full adjustment's information N, and is itself wrong by as much as it is. What noise hides
/// is of a size with the noise: if the bundle is there, theta ~ N(0, g W^-1), W = N_ll - N_lk K,
/// with all shares of the whole g / (1 + g) alike before the readings (the hyper-g prior, a = 4, of
/// Liang, Paulo, Molina, Clyde and Berger 2008). Of n coefficients found as theta_full, with
/// Q = theta_full' W theta_full, the share of noise k = 1 / (1 + g) then has the density
/// k^(n/2) exp(-k Q / 2), and theta
///   the mean m = (1 - E k) theta_full, P = (1 - E k) W^-1 + var(k) theta_full theta_full'.
/// That it is there has, of even odds, the probability p. The kept parameters are taken for the
/// mean p m, and theirs is one error among those of the noise: p P + p (1 - p) m m'.
///
/// A coefficient itself has no other error. Whether it is there or not, P counts in full: readings
/// are unsure of a sensitivity's change with temperature that they do not show, and no sensor's
/// coefficient is nothing at all.
LeftOutErrors LeftOutErrorsOf(const std::vector<TermBundle>& bundles, const std::vector<int>& seen,
                              const std::vector<int>& kept, const ToolAdjustment& full);

}  // namespace wellgyro
