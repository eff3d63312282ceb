#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "wellgyro/record/sample.h"

/// Numbers of several samples side by side: what the processor does with one number it does with
/// several at once. Types with one number and with four have the same operations, rounded alike.
namespace wellgyro {

using Doubles2 [[gnu::vector_size(16)]] = double;
using Singles4 [[gnu::vector_size(16)]] = float;
using Wholes4 [[gnu::vector_size(16)]] = std::int32_t;
using Longs2 [[gnu::vector_size(16)]] = std::int64_t;
using Pairs [[gnu::vector_size(32)]] = double;

struct Doubles4 {
  Doubles2 low, high;
};
[[gnu::always_inline]] inline Doubles4 HalvesOf(const Pairs& n) {
  return {__builtin_shufflevector(n, n, 0, 1), __builtin_shufflevector(n, n, 2, 3)};
}
[[gnu::always_inline]] inline Doubles4 operator+(Doubles4 a, Doubles4 b) {
  return {a.low + b.low, a.high + b.high};
}
[[gnu::always_inline]] inline Doubles4 operator-(Doubles4 a, Doubles4 b) {
  return {a.low - b.low, a.high - b.high};
}
[[gnu::always_inline]] inline Doubles4 operator*(Doubles4 a, Doubles4 b) {
  return {a.low * b.low, a.high * b.high};
}

template <int kN>
struct LanesOf;
template <>
struct LanesOf<1> {
  using Double = double;
  using Single = float;
  using Whole = std::int32_t;
};
template <>
struct LanesOf<4> {
  using Double = Doubles4;
  using Single = Singles4;
  using Whole = Wholes4;
};

[[gnu::always_inline]] inline double ToDouble(std::int32_t n) { return n; }
[[gnu::always_inline]] inline double ToDouble(float n) { return static_cast<double>(n); }
[[gnu::always_inline]] inline float ToSingle(std::int32_t n) { return static_cast<float>(n); }
[[gnu::always_inline]] inline float ToSingle(double n) { return static_cast<float>(n); }
[[gnu::always_inline]] inline Doubles4 ToDouble(Wholes4 n) {
  return HalvesOf(__builtin_convertvector(n, Pairs));
}
[[gnu::always_inline]] inline Doubles4 ToDouble(Singles4 n) {
  return HalvesOf(__builtin_convertvector(n, Pairs));
}
[[gnu::always_inline]] inline Singles4 ToSingle(Wholes4 n) {
  return __builtin_convertvector(n, Singles4);
}
[[gnu::always_inline]] inline Singles4 ToSingle(Doubles4 n) {
  return __builtin_convertvector(__builtin_shufflevector(n.low, n.high, 0, 1, 2, 3), Singles4);
}

/// From the first of consecutive numbers.
template <int kN>
[[gnu::always_inline]] inline typename LanesOf<kN>::Single Load(const float* from) {
  typename LanesOf<kN>::Single numbers;
  std::memcpy(&numbers, from, sizeof(numbers));
  return numbers;
}

[[gnu::always_inline]] inline double At(double n, std::size_t) { return n; }
[[gnu::always_inline]] inline float At(float n, std::size_t) { return n; }
[[gnu::always_inline]] inline float At(Singles4 n, std::size_t k) { return n[k]; }
[[gnu::always_inline]] inline double At(Doubles4 n, std::size_t k) {
  return k < 2 ? n.low[k] : n.high[k - 2];
}

[[gnu::always_inline]] inline void SetAt(double& n, std::size_t, double to) { n = to; }
[[gnu::always_inline]] inline void SetAt(Doubles4& n, std::size_t k, double to) {
  (k < 2 ? n.low : n.high)[k % 2] = to;
}

[[gnu::always_inline]] inline bool AnyAbove(float n, float limit) { return n > limit; }
[[gnu::always_inline]] inline bool AnyAbove(Singles4 n, Singles4 limit) {
  const auto above = std::bit_cast<Longs2>(n > limit);
  return (above[0] | above[1]) != 0;
}

/// Component by component of kN samples to where each has its three.
[[gnu::always_inline]] inline void Scatter(const std::array<double, 3>& u,
                                           const std::array<double*, 1>& to) {
  for (std::size_t i = 0; i < 3; ++i) to[0][i] = u[i];
}
[[gnu::always_inline]] inline void Scatter(Doubles2 x, Doubles2 y, Doubles2 z, double* first,
                                           double* second) {
  const Doubles2 a = __builtin_shufflevector(x, y, 0, 2), b = __builtin_shufflevector(x, y, 1, 3);
  std::memcpy(first, &a, sizeof(a));
  std::memcpy(second, &b, sizeof(b));
  first[2] = z[0];
  second[2] = z[1];
}
[[gnu::always_inline]] inline void Scatter(const std::array<Doubles4, 3>& u,
                                           const std::array<double*, 4>& to) {
  Scatter(u[0].low, u[1].low, u[2].low, to[0], to[1]);
  Scatter(u[0].high, u[1].high, u[2].high, to[2], to[3]);
}

/// A number that is the same for every sample.
struct SameDouble {
  Doubles2 twice{};
  void operator=(double n) { twice = Doubles2{n, n}; }
};
struct SameSingle {
  Singles4 fourfold{};
  void operator=(double number) {
    const auto n = static_cast<float>(number);
    fourfold = Singles4{n, n, n, n};
  }
};
template <int kN>
[[gnu::always_inline]] inline typename LanesOf<kN>::Double Of(const SameDouble& n) {
  if constexpr (kN == 1) {
    return n.twice[0];
  } else {
    return {n.twice, n.twice};
  }
}
template <int kN>
[[gnu::always_inline]] inline typename LanesOf<kN>::Single Of(const SameSingle& n) {
  if constexpr (kN == 1) {
    return n.fourfold[0];
  } else {
    return n.fourfold;
  }
}

/// Counts of kN samples, channel by channel.
template <int kN>
class CountsOf {
 public:
  [[gnu::always_inline]] CountsOf(const RawSample* raw, std::size_t channels) {
    for (std::size_t c = 0; c < channels; c += 4) {
      if constexpr (kN == 1) {
        for (std::size_t i = c; i < c + 4; ++i) counts_[i] = raw->counts[i];
      } else {
        TakeFour(raw, c);
      }
    }
  }
  [[gnu::always_inline]] typename LanesOf<kN>::Whole operator[](std::size_t channel) const {
    return counts_[channel];
  }

 private:
  static_assert(RawSample::kChannelsMax % 4 == 0);

  /// Four channels of four samples.
  [[gnu::always_inline]] void TakeFour(const RawSample* raw, std::size_t c) {
    std::array<Wholes4, 4> rows;
    for (std::size_t k = 0; k < 4; ++k) std::memcpy(&rows[k], &raw[k].counts[c], sizeof(Wholes4));
    const Wholes4 a = __builtin_shufflevector(rows[0], rows[1], 0, 4, 1, 5);
    const Wholes4 b = __builtin_shufflevector(rows[2], rows[3], 0, 4, 1, 5);
    counts_[c] = __builtin_shufflevector(a, b, 0, 1, 4, 5);
    counts_[c + 1] = __builtin_shufflevector(a, b, 2, 3, 6, 7);
    const Wholes4 d = __builtin_shufflevector(rows[0], rows[1], 2, 6, 3, 7);
    const Wholes4 e = __builtin_shufflevector(rows[2], rows[3], 2, 6, 3, 7);
    counts_[c + 2] = __builtin_shufflevector(d, e, 0, 1, 4, 5);
    counts_[c + 3] = __builtin_shufflevector(d, e, 2, 3, 6, 7);
  }

  std::array<typename LanesOf<kN>::Whole, RawSample::kChannelsMax> counts_;
};

}  // namespace wellgyro
