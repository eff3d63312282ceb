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
/// the full adjustment's information N, and is itself wrong by as much as it is. Noise hides what
/// is no larger than the sigma s of an adjustment of its bundle beside the kept ones, so if the
/// bundle is there at all, theta ~ N(0, s^2), of which the readings leave
///   P = (W + diag(1 / s^2))^-1 about m = P h,   W = N_ll - N_lk K,  h = W theta_full;
/// that it is there has, of even odds, the probability p by the readings. Then theta has the mean
/// p m and about it the covariance p P + p (1 - p) m m'. The kept parameters are taken for that
/// mean: for none at all they are wrong by more, and their sigmas larger by more than they are
/// wrong where nothing is left out that is there.
///
/// Theirs is one error among those of the noise, and a variance tells it. A coefficient itself has
/// no other: by p alone it would be sure to sqrt(p) s, and beyond 1 / sqrt(p) of these sigmas as
/// often as p; nor is any sensor's coefficient nothing at all. Whether it is there or not, the
/// readings leave P of it, which counts in full: they are unsure of a sensitivity's change with
/// temperature that they do not show, though a bundle's other channels speak against it.
LeftOutErrors LeftOutErrorsOf(const std::vector<TermBundle>& bundles, const std::vector<int>& seen,
                              const std::vector<int>& kept, const ToolAdjustment& full);

}  // namespace wellgyro
