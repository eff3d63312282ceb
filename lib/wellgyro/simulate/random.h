#pragma once

#include <array>
#include <cstdint>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Random numbers that are the same on every machine: xoshiro256++ (Blackman and Vigna, "Scrambled
/// linear pseudorandom number generators", ACM TOMS 47(4), 2021), seeded through splitmix64.
/// Streams of one seed are independent, so that one more error in a simulation leaves the others'
/// draws.
class WELLGYRO_EXPORT Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream);

  /// The next 64 bits.
  std::uint64_t Bits();
  /// Uniform in [0, 1), a multiple of 2^-53.
  double Uniform();
  /// Standard normal, by Marsaglia's polar method: portable as far as std::log and std::sqrt are.
  double Normal();

 private:
  std::array<std::uint64_t, 4> state_{};
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace wellgyro
