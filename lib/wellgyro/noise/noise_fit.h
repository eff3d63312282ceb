#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/noise/allan_variance.h"
#include "wellgyro/noise/noise_model.h"

namespace wellgyro {

struct NoiseFitOptions {
  /// Fit bias instability as a Gauss-Markov process, its correlation time found, in place of
  /// flicker noise.
  bool gauss_markov = false;
  double sinusoid_frequency = 0;  ///< of a sinusoid to be fitted as well [Hz]; 0: none
  std::uint64_t seed = 1;         ///< of the bootstrap
  int replicates = 1000;          ///< of the bootstrap, at least 40
  std::function<void(double)> progress;
};

/// What a log says about one term.
struct TermFit {
  bool observable = false;
  double value = 0;       ///< coefficient, where observable
  double sigma = 0;       ///< likewise: half the 99 % range over 2.576
  double lower95 = 0;     ///< likewise
  double upper95 = 0;     ///< two-sided with `lower95` where observable, else one-sided
  double gain = 0;        ///< of deviance by the term
  double gain_limit = 0;  ///< that a term which is not there exceeds once in twenty
};

struct NoiseFit {
  PerTerm<TermFit> term{};
  /// As fitted, with what terms that are not observable took: the best description of the table.
  NoiseModel model;
  std::optional<double> sigma_correlation_time;  ///< [s]; for Gauss-Markov
  double deviance = 0;  ///< of the table from the model; about `points` less terms when it fits
  int points = 0;       ///< averaging times used
};

/// Noise coefficients from overlapped Allan variances at octaves.
///
/// Sample variances are taken as chi-square with the model's own equivalent degrees of freedom and
/// fitted by non-negative weights (quasi-likelihood, so that the fit is not drawn to the low ones).
/// A ramp, which steals from random walk, is kept only when observable. A term is observable when
/// the deviance it gains exceeds what it would gain by chance in 95 of 100 logs without it. Bounds
/// and sigmas come from a parametric bootstrap that draws whole tables with the correlation of
/// neighbouring averaging times; the upper bound of a term that is not observable comes from its
/// profile deviance, the limit again by bootstrap. On logs of 1e6 samples the intervals of
/// observable terms, and value +- 1.96 sigma, hold the truth in 94 to 97 of 100
/// (tests/noise/allan_long_test.cpp).
///
/// Averaging times are used up to two fifths of the log. A Fault of code kRange when fewer than
/// three averaging times have a variance above zero, or a ramp explains them all. Throws
/// std::invalid_argument for another kind of deviation or factors that are not octaves.
WELLGYRO_EXPORT Result<NoiseFit> FitNoise(const AllanResult& octaves,
                                          const NoiseFitOptions& options = {});

/// The observable terms as a record.
WELLGYRO_EXPORT NoiseCoefficients CoefficientsOf(const NoiseFit& fit);

}  // namespace wellgyro
