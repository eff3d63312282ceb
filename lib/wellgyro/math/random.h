#pragma once

#include <array>
#include <cstdint>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Random numbers from a seed: the same on every machine, bit for bit, and in every release.
///
/// xoshiro256++ (Blackman and Vigna 2021), its state filled from the seed by SplitMix64. Nothing
/// here calls a library's transcendental function, whose last bit differs between systems.
class WELLGYRO_EXPORT Random {
 public:
  explicit Random(std::uint64_t seed);

  /// 64 uniform bits.
  std::uint64_t Bits();
  /// Uniform in [0, 1), a multiple of 2^-53.
  double Uniform();
  /// Standard normal, by the ratio of uniforms (Leva 1992), two uniforms and no logarithm as a
  /// rule.
  double Normal();

 private:
  std::array<std::uint64_t, 4> state_;
};

}  // namespace wellgyro
