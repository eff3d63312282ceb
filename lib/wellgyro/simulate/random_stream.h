#pragma once

#include <cstdint>

#include "wellgyro/math/random.h"

namespace wellgyro {

/// The `stream`-th generator of one seed. Streams are independent of each other, so that one more
/// error in a simulation leaves the draws of the others as they were.
inline Random RandomStream(std::uint64_t seed, std::uint64_t stream) {
  // The finaliser of SplitMix64: neighbouring streams share no bits with each other or the seed.
  std::uint64_t z = (stream + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return Random(seed ^ (z ^ (z >> 31)));
}

}  // namespace wellgyro
