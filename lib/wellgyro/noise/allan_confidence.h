#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/noise/allan_variance.h"
#include "wellgyro/noise/noise_model.h"

namespace wellgyro {

/// How many independent squares a sample variance is worth: 2 mean^2/variance, for noise of the
/// model at averaging factor `factor` from `terms` differences of one uninterrupted log.
///
/// From the autocovariance of the differences themselves, for the mixture that the model is, not
/// from a fit to simulations: exact for factors up to 16 (white, flicker and random walk of rate,
/// white phase), to 2 % above. A ramp adds to the mean and nothing to its scatter; a sinusoid is
/// left out. 0 for no terms. Modified: to 4 %.
WELLGYRO_EXPORT double EquivalentDof(const NoiseModel& model, double period, std::int64_t factor,
                                     std::int64_t terms, Deviation deviation);

/// Covariance of overlapped sample variances at octaves, `factors` and `terms` as in the table:
/// what the fit's bootstrap draws from. Octaves more than eight apart are taken as independent.
WELLGYRO_EXPORT Eigen::MatrixXd OctaveCovariance(const NoiseModel& model, double period,
                                                 std::span<const std::int64_t> factors,
                                                 std::span<const std::int64_t> terms);

/// Two-sided bounds on the true variance.
struct VarianceInterval {
  double lower = 0;
  double upper = 0;
};
/// edf s2/chi2, by the chi-square law. Throws std::domain_error for edf <= 0 or confidence outside
/// (0, 1).
WELLGYRO_EXPORT VarianceInterval ChiSquareInterval(double variance, double edf, double confidence);

/// A line of a table of Allan variances.
struct AllanRow {
  AllanPoint point;
  double edf = 0;
  VarianceInterval interval95;
  double model = 0;  ///< variance of the model there
  NoiseTerm dominant = NoiseTerm::kAngleRandomWalk;
};

/// The points that have terms and a variance above zero, with the degrees of freedom, bounds and
/// dominant term that `model` gives them.
WELLGYRO_EXPORT std::vector<AllanRow> AllanTable(const AllanResult& result,
                                                 const NoiseModel& model);

}  // namespace wellgyro
