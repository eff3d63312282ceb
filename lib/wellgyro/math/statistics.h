#pragma once

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Regularised incomplete gamma functions P(a, x) and Q(a, x) = 1 - P(a, x), a > 0, x >= 0; both
/// keep their relative accuracy, 1e-10, in their small tail. Series and continued fraction
/// (DLMF 8.11.4, 8.9.2) for a < 2e4, above it Temme's uniform expansion (DLMF 8.12). Throw
/// std::domain_error outside.
WELLGYRO_EXPORT double GammaP(double a, double x);
WELLGYRO_EXPORT double GammaQ(double a, double x);

/// P(X <= x) of the chi-square distribution with `dof` > 0 degrees of freedom, not necessarily
/// whole; 0 for x < 0. Relative error below 1e-10 for dof up to 1e9. Throws std::domain_error for
/// dof <= 0 or not a number.
WELLGYRO_EXPORT double ChiSquareCdf(double x, double dof);

/// The x below which chi-square stays with `probability` in (0, 1); relative error below 1e-10 for
/// dof in [0.3, 1e9]. Throws std::domain_error for a probability outside (0, 1) or dof <= 0.
WELLGYRO_EXPORT double ChiSquareQuantile(double probability, double dof);

/// P(X <= x) of the standard normal distribution.
WELLGYRO_EXPORT double NormalCdf(double x);

/// Its inverse, to 1e-14 relative; throws std::domain_error outside (0, 1).
WELLGYRO_EXPORT double NormalQuantile(double probability);

/// The t that Student's distribution passes with `probability` below 1/2, dof > 0; to 1 % for
/// dof > 3, and where the probability is above 0.02 for dof >= 2.
WELLGYRO_EXPORT double StudentLimit(double probability, double dof);

}  // namespace wellgyro
