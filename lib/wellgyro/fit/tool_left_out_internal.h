#pragma once

#include <vector>

#include <Eigen/Core>

#include "wellgyro/fit/tool_adjust_internal.h"

namespace wellgyro {

/// What leaving terms out does to a calibration.
struct LeftOutErrors {
  std::vector<ToolTerm> terms;  ///< that the readings could tell, and were not kept
  /// Of the errors of the kept parameters and, behind them, of these coefficients, which are taken
  /// for zero, beside what the readings' noise does.
  Eigen::MatrixXd cov;
};

/// A coefficient theta that is left out moves the kept parameters by K theta, K = N_kk^-1 N_kl of
/// the full adjustment's information N, and is itself wrong by as much as it is. Noise hides what
/// is no larger than the full adjustment's sigma s, so theta ~ N(0, s^2), of which the readings
/// leave
///   P = (W + diag(1 / s^2))^-1 about m = P W theta_full,   W = N_ll - N_lk K,
/// and its square about the zero for which it is taken is P + m m', times the probability that its
/// bundle is there at all. Where readings say little of a term, as of a sensitivity's change with a
/// temperature at which no rate table was read, s is large; where they rule it out, it is nothing.
LeftOutErrors LeftOutErrorsOf(const std::vector<TermBundle>& bundles, const std::vector<int>& seen,
                              const std::vector<int>& kept, const ToolAdjustment& full);

}  // namespace wellgyro
