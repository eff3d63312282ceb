#pragma once

#include <vector>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// The middle of `values` by size, of an even number the upper one of the two; 0 of none. Orders by
/// <, so that a value that is no number gives an answer without meaning.
WELLGYRO_EXPORT double Median(std::vector<double> values);

/// Of a normal distribution, sigma over the median of the sizes of its deviations: half of them are
/// less than Phi^-1(3/4) sigma, Phi^-1(3/4) = 0.6745, and this is its reciprocal.
inline constexpr double kSigmaPerMedianSize = 1.4826;

/// Sigma of a normal distribution by that median, of the deviations' `sizes`.
WELLGYRO_EXPORT double RobustSigma(std::vector<double> sizes);
/// The same by the deviations of `values` from `middle`.
WELLGYRO_EXPORT double RobustSigma(std::vector<double> values, double middle);

}  // namespace wellgyro
