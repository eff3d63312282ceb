#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "wellgyro/math/random.h"
#include "wellgyro/record/noise.h"

/// Logs of known noise, made by methods that share nothing with the estimators.
namespace wellgyro::test {

/// Two independent logs of flicker noise whose Allan deviation is flat at 0.664 b: a periodic
/// process of twice the length, synthesised from the spectrum of Kasdin's discrete flicker noise
/// (Proc. IEEE 83, 1995), b^2/(2 |sin(pi f)|) per cycle a sample. At m samples its Allan variance
/// is above the flat by 44 % (m = 1), 5 % (4), 1.5 % (8), 0.1 % (32).
std::pair<std::vector<double>, std::vector<double>> FlickerPair(std::size_t samples, double b,
                                                                Random& random);

/// Two independent logs of mean rates with the given coefficients; white noise, random walk, ramp
/// and quantisation have exactly their Allan variance at every m, B is flicker noise.
std::pair<std::vector<double>, std::vector<double>> LogPair(std::size_t samples, double period,
                                                            const NoiseCoefficients& truth,
                                                            std::uint64_t seed);

}  // namespace wellgyro::test
