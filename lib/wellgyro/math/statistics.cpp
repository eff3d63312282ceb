#include "wellgyro/math/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace wellgyro {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// From which on Temme's uniform expansion serves: its first term left out, 25 / (6048 a^2), is
// 1e-11 beside the 1/3 that it begins with.
constexpr double kUniformFrom = 2e4;

void Require(bool good, const char* what, double value) {
  if (!good) throw std::domain_error(std::string(what) + ", not " + std::to_string(value));
}

double NormalDensity(double z) { return std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi); }

// x^a e^-x / Gamma(a + 1). Near x = a the three logarithms cancel: there by Stirling's series.
double Prefactor(double a, double x) {
  if (a < 10) return std::exp(a * std::log(x) - x - std::lgamma(a + 1));
  const double d = (x - a) / a;
  const double exponent = a * (std::log1p(d) - d);
  const double a2 = a * a;
  const double stirling = (1 / 12. - (1 / 360. - (1 / 1260. - 1 / (1680. * a2)) / a2) / a2) / a;
  return std::exp(exponent - stirling) / std::sqrt(2 * std::numbers::pi * a);
}

double SeriesP(double a, double x) {
  double term = 1;
  double sum = 1;
  for (double n = a + 1; term > sum * kEpsilon / 4; ++n) sum += (term *= x / n);
  return Prefactor(a, x) * sum;
}

// Lentz's evaluation of the continued fraction of Gamma(a, x).
double FractionQ(double a, double x) {
  constexpr double kTiny = 1e-300;  // for a zero, by Lentz's rule: its reciprocal is finite
  double b = x + 1 - a;
  double c = 1 / kTiny;
  double d = 1 / b;
  double h = d;
  for (int i = 1; i < 100000; ++i) {
    const double an = -i * (i - a);
    b += 2;
    d = an * d + b;
    d = 1 / (std::abs(d) < kTiny ? kTiny : d);
    c = b + an / c;
    if (std::abs(c) < kTiny) c = kTiny;
    const double delta = d * c;
    h *= delta;
    if (std::abs(delta - 1) < kEpsilon) break;
  }
  return Prefactor(a, x) * a * h;
}

// Tail beyond x on the side that `upper` says, for large a.
double UniformTail(double a, double x, bool upper) {
  const double mu = (x - a) / a;
  const double half_eta2 = mu - std::log1p(mu);
  const double eta = std::copysign(std::sqrt(2 * half_eta2), mu);
  double c0 = 0;
  double c1 = 0;
  if (std::abs(eta) < 0.1) {
    c0 = -1 / 3. + eta * (1 / 12. - eta * (2 / 135. - eta * (1 / 864. + eta * (1 / 2835.))));
    c1 = -1 / 540. - eta / 288.;
  } else {
    c0 = 1 / mu - 1 / eta;
    c1 = 1 / (eta * eta * eta) - 1 / (mu * mu * mu) - 1 / (mu * mu) - 1 / (12 * mu);
  }
  const double correction =
      std::exp(-a * half_eta2) / std::sqrt(2 * std::numbers::pi * a) * (c0 + c1 / a);
  const double s = eta * std::sqrt(a / 2);
  return upper ? std::erfc(s) / 2 + correction : std::erfc(-s) / 2 - correction;
}

}  // namespace

double NormalCdf(double z) { return std::erfc(-z / std::numbers::sqrt2) / 2; }

double NormalQuantile(double p) {
  Require(p > 0 && p < 1, "NormalQuantile: p must be inside (0, 1)", p);
  if (p > 0.5) return -NormalQuantile(1 - p);
  if (p == 0.5) return 0;
  // A start good to 5e-4 (Hastings 1955), then Halley's iteration.
  const double t = std::sqrt(-2 * std::log(p));
  double z = -(t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                       (1 + t * (1.432788 + t * (0.189269 + t * 0.001308))));
  for (int i = 0; i < 3; ++i) {
    const double step = (NormalCdf(z) - p) / NormalDensity(z);
    z -= step / (1 + z * step / 2);
  }
  return z;
}

double GammaP(double a, double x) {
  Require(a > 0 && std::isfinite(a), "GammaP: a must be positive", a);
  Require(x >= 0, "GammaP: x must not be negative", x);
  if (x == 0) return 0;
  if (std::isinf(x)) return 1;
  if (a >= kUniformFrom) return UniformTail(a, x, false);
  return x < a + 1 ? SeriesP(a, x) : 1 - FractionQ(a, x);
}

double GammaQ(double a, double x) {
  Require(a > 0 && std::isfinite(a), "GammaQ: a must be positive", a);
  Require(x >= 0, "GammaQ: x must not be negative", x);
  if (x == 0) return 1;
  if (std::isinf(x)) return 0;
  if (a >= kUniformFrom) return UniformTail(a, x, true);
  return x < a + 1 ? 1 - SeriesP(a, x) : FractionQ(a, x);
}

double ChiSquareCdf(double x, double dof) {
  Require(dof > 0 && std::isfinite(dof), "ChiSquareCdf: dof must be positive", dof);
  Require(!std::isnan(x), "ChiSquareCdf: x must be a number", x);
  return x > 0 ? GammaP(dof / 2, x / 2) : 0;
}

double ChiSquareQuantile(double p, double dof) {
  Require(p > 0 && p < 1, "ChiSquareQuantile: p must be inside (0, 1)", p);
  Require(dof > 0 && std::isfinite(dof), "ChiSquareQuantile: dof must be positive", dof);
  const double a = dof / 2;
  // Wilson and Hilferty; where it fails, deep in the lower tail, the first term of the series.
  const double w = 1 / (9 * a);
  double x = a * std::pow(std::max(0., 1 - w + NormalQuantile(p) * std::sqrt(w)), 3);
  if (x < 0.2 * a) x = std::exp((std::log(p) + std::lgamma(a + 1)) / a);
  // Newton in ln x on the logarithm of the smaller tail, held inside a shrinking bracket.
  double low = 0;
  double high = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 100 && x > 0; ++i) {
    const bool lower_tail = p < 0.5;
    const double tail = lower_tail ? GammaP(a, x) : GammaQ(a, x);
    const double error = lower_tail ? std::log(tail / p) : -std::log(tail / (1 - p));
    (error > 0 ? high : low) = x;
    const double density_times_x = Prefactor(a, x) * a;
    double next = x * std::exp(-error * tail / density_times_x);
    if (!(next > low && next < high)) next = std::isinf(high) ? 2 * x : (low + high) / 2;
    if (std::abs(next - x) <= 4 * kEpsilon * x) return 2 * next;
    x = next;
  }
  return 2 * x;
}

double StudentLimit(double probability, double dof) {
  // Cornish and Fisher's expansion, Abramowitz and Stegun 26.7.5.
  const double z = -NormalQuantile(probability), z2 = z * z;
  const double g1 = z * (z2 + 1) / 4;
  const double g2 = z * ((5 * z2 + 16) * z2 + 3) / 96;
  const double g3 = z * (((3 * z2 + 19) * z2 + 17) * z2 - 15) / 384;
  const double g4 = z * ((((79 * z2 + 776) * z2 + 1482) * z2 - 1920) * z2 - 945) / 92160;
  return z + (g1 + (g2 + (g3 + g4 / dof) / dof) / dof) / dof;
}

}  // namespace wellgyro
