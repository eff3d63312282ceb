#include "wellgyro/math/drift.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "wellgyro/math/square.h"

namespace wellgyro {
namespace {

// 2x - 3 + 4 e^-x - e^-2x, which is 2/3 x^3 for small x and cancels there.
double MarkovIntegralVariance(double x) {
  const double u = -std::expm1(-x);
  if (x > 0.5) return 2 * x - 2 * u - u * u;
  double sum = 0, power = x * x / 2, two = 4;  // x^n / n! and 2^n at n = 2
  for (int n = 3; n <= 18; ++n) {
    power *= -x / n;  // carries (-1)^n as well, n = 2 being even
    two *= 2;
    sum += power * (4 - two);
  }
  return sum;
}

void AddMarkov(const DriftCoefficients& drift, double gain, double seconds, DriftStep* step) {
  const double tc = *drift.correlation_time;
  const double x = seconds / tc, decay = std::exp(-x), u = -std::expm1(-x);
  const double variance = Square(kMarkovSigmaPerInstability * drift.bias_instability);
  step->transition(kDriftIntegral, kDriftMarkov) = gain * tc * u;
  step->transition(kDriftMarkov, kDriftMarkov) = decay;
  step->noise(kDriftIntegral, kDriftIntegral) +=
      variance * Square(gain * tc) * MarkovIntegralVariance(x);
  const double cross = variance * gain * tc * u * u;
  step->noise(kDriftIntegral, kDriftMarkov) = cross;
  step->noise(kDriftMarkov, kDriftIntegral) = cross;
  step->noise(kDriftMarkov, kDriftMarkov) = variance * u * (1 + decay);
}

}  // namespace

DriftStep DriftOver(const DriftCoefficients& drift, double gain, double seconds) {
  if (!(seconds >= 0)) {
    throw std::domain_error("DriftOver: seconds is " + std::to_string(seconds));
  }
  if (drift.correlation_time && !(*drift.correlation_time > 0)) {
    throw std::domain_error("DriftOver: correlation_time is " +
                            std::to_string(*drift.correlation_time) + " s");
  }
  DriftStep step;
  step.transition(kDriftIntegral, kDriftLevel) = gain * seconds;
  step.transition(kDriftIntegral, kDriftRamp) = gain * seconds * seconds / 2;
  step.transition(kDriftLevel, kDriftRamp) = seconds;

  const double walk = Square(drift.rate_random_walk) * seconds;
  step.noise(kDriftIntegral, kDriftIntegral) =
      Square(gain) * (Square(drift.angle_random_walk) * seconds + walk * seconds * seconds / 3);
  step.noise(kDriftIntegral, kDriftLevel) = gain * walk * seconds / 2;
  step.noise(kDriftLevel, kDriftIntegral) = gain * walk * seconds / 2;
  step.noise(kDriftLevel, kDriftLevel) = walk;
  if (drift.correlation_time) AddMarkov(drift, gain, seconds, &step);
  return step;
}

Eigen::Matrix4d DriftPrior(const DriftCoefficients& drift) {
  Eigen::Vector4d variance = Eigen::Vector4d::Zero();
  variance[kDriftLevel] = Square(drift.constant);
  const double instability = Square(drift.bias_instability);
  if (drift.correlation_time) {
    variance[kDriftMarkov] = Square(kMarkovSigmaPerInstability) * instability;
  } else {
    variance[kDriftLevel] += instability;
  }
  variance[kDriftRamp] = Square(drift.rate_ramp);
  return variance.asDiagonal();
}

}  // namespace wellgyro
