#pragma once

#include <cstdint>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/math/random.h"
#include "wellgyro/record/noise.h"

namespace wellgyro {

/// First-order Gauss-Markov process, stationary from the begin.
class WELLGYRO_EXPORT GaussMarkov {
 public:
  /// `correlation_time` [s] positive.
  GaussMarkov(double sigma, double correlation_time, Random random);
  /// Its mean over the next `seconds`: exact for any length, jointly with its state at the end.
  double Mean(double seconds);

 private:
  double sigma_;
  double correlation_time_;
  Random random_;
  double value_;
};

/// Rate noise of one gyro axis as its Allan coefficients say, quantisation excepted. Means over
/// successive samples have the exact joint law of the continuous processes, whatever the sample
/// rate. The constant part of B is drawn with sigma B; the ramp is R t or -R t.
class WELLGYRO_EXPORT RateNoise {
 public:
  /// `flicker`: B as 1/f noise from a bank of Gauss-Markov processes a factor 4 apart, each of
  /// variance B^2 ln 4 / pi (the sum of their densities is B^2 / (2 pi f)).
  RateNoise(const NoiseCoefficients& noise, bool flicker, std::uint64_t seed, std::uint64_t stream);

  /// Mean over the next `seconds` [rad/s].
  double Mean(double seconds);

 private:
  NoiseCoefficients noise_;
  Random white_;
  Random walk_random_;
  std::vector<GaussMarkov> instability_;
  double constant_ = 0;
  double ramp_ = 0;
  double walk_ = 0;
  double time_ = 0;
};

}  // namespace wellgyro
