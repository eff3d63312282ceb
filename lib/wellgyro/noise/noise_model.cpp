#include "wellgyro/noise/noise_model.h"

#include <cmath>
#include <numbers>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/drift.h"

namespace wellgyro {
namespace {

// Of a Gauss-Markov process of unit sigma at u = tau/T: (2/u)(1 - (3 - 4 e^-u + e^-2u)/(2u)).
double GaussMarkovVariance(double u) {
  // The bracket cancels to u^2/3 - u^3/4 for short times.
  if (u < 1e-3) return 2 * u / 3 * (1 - 0.75 * u + 0.35 * u * u);
  const double e = -std::expm1(-u);  // 3 - 4x + x^2 = 2e + e^2 with x = 1 - e
  return 2 / u * (1 - (2 * e + e * e) / (2 * u));
}

}  // namespace

double UnitAllanVariance(NoiseTerm term, const NoiseShape& shape, double tau) {
  switch (term) {
    case NoiseTerm::kQuantization:
      return 3 / (tau * tau);
    case NoiseTerm::kAngleRandomWalk:
      return 1 / tau;
    case NoiseTerm::kBiasInstability: {
      if (!shape.correlation_time) return 2 * std::numbers::ln2 / kPi;
      constexpr double kSigma2 = kMarkovSigmaPerInstability * kMarkovSigmaPerInstability;
      return kSigma2 * GaussMarkovVariance(tau / *shape.correlation_time);
    }
    case NoiseTerm::kRateRandomWalk:
      return tau / 3;
    case NoiseTerm::kRateRamp:
      return tau * tau / 2;
    case NoiseTerm::kSinusoid:
      break;
  }
  const double x = kPi * shape.sinusoid_frequency * tau;
  if (x == 0) return 0;
  const double s = std::sin(x);
  return std::pow(s * s / x, 2);
}

double ModelAllanVariance(const NoiseModel& model, double tau) {
  double variance = 0;
  for (const auto term : kAllNoiseTerms) {
    const double c = model.coefficient[term];
    if (c > 0) variance += c * c * UnitAllanVariance(term, model.shape, tau);
  }
  return variance;
}

NoiseTerm DominantTerm(const NoiseModel& model, double tau) {
  NoiseTerm dominant = NoiseTerm::kAngleRandomWalk;
  double largest = 0;
  for (const auto term : kAllNoiseTerms) {
    const double c = model.coefficient[term];
    const double part = c > 0 ? c * c * UnitAllanVariance(term, model.shape, tau) : 0;
    if (part > largest) {
      largest = part;
      dominant = term;
    }
  }
  return dominant;
}

}  // namespace wellgyro
