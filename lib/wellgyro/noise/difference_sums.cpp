#include <array>
#include <cstring>

#include "wellgyro/noise/difference_sums_internal.h"

// The sums run in eight lanes whatever the width of the processor's registers, and nothing is
// contracted, so that each width gives the same bits.

namespace wellgyro {
namespace {

constexpr int kLanes = 8;  // doubles in the widest register, 512 bits

// Half a second difference, (x - near) - (x - far)/2: two subtractions and an exact halving.
template <class Vector, int kOctaves>
[[gnu::always_inline]] inline void AddChain(const double* x, const double* const* lags,
                                            std::int64_t n, double* sums) {
  constexpr int kWidth = sizeof(Vector) / sizeof(double);
  constexpr int kParts = kLanes / kWidth;
  Vector total[kOctaves][kParts] = {};
  std::int64_t i = 0;
  for (; i + kLanes <= n; i += kLanes) {
#pragma GCC unroll 4
    for (int part = 0; part < kParts; ++part) {
      const std::int64_t at = i + std::int64_t{part} * kWidth;
      Vector here;
      Vector lag;
      std::memcpy(&here, x + at, sizeof here);
      std::memcpy(&lag, lags[0] + at, sizeof lag);
      Vector near = here - lag;
#pragma GCC unroll 8
      for (int j = 0; j < kOctaves; ++j) {
        std::memcpy(&lag, lags[j + 1] + at, sizeof lag);
        const Vector far = here - lag;
        const Vector half = near - 0.5 * far;
        total[j][part] += half * half;
        near = far;
      }
    }
  }
  for (int j = 0; j < kOctaves; ++j) {
    std::array<double, kLanes> lane;
    std::memcpy(lane.data(), total[j], sizeof lane);
    double sum =
        ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
    for (std::int64_t k = i; k < n; ++k) {
      const double half = (x[k] - lags[j][k]) - 0.5 * (x[k] - lags[j + 1][k]);
      sum += half * half;
    }
    sums[j] += 4 * sum;
  }
}

template <class Vector>
[[gnu::always_inline]] inline void AddOctaves(const double* x, const double* const* lags,
                                              int octaves, std::int64_t n, double* sums) {
  switch (octaves) {
    case 1:
      return AddChain<Vector, 1>(x, lags, n, sums);
    case 2:
      return AddChain<Vector, 2>(x, lags, n, sums);
    case 3:
      return AddChain<Vector, 3>(x, lags, n, sums);
    case 4:
      return AddChain<Vector, 4>(x, lags, n, sums);
    case 5:
      return AddChain<Vector, 5>(x, lags, n, sums);
    case 6:
      return AddChain<Vector, 6>(x, lags, n, sums);
    case 7:
      return AddChain<Vector, 7>(x, lags, n, sums);
    default:
      return AddChain<Vector, 8>(x, lags, n, sums);
  }
}

[[gnu::always_inline]] inline void Place(const double* sums, std::int64_t n, double before,
                                         double low, double high, double* local, double* phases) {
  for (std::int64_t i = 0; i < n; ++i) {
    const double near = sums[i] + before;
    local[i] = near;
    phases[i] = high + (low + near);
  }
}

using Two [[gnu::vector_size(16)]] = double;
using Four [[gnu::vector_size(32)]] = double;
using Eight [[gnu::vector_size(64)]] = double;

void AddPlain(const double* x, const double* const* lags, int octaves, std::int64_t n,
              double* sums) {
  // Sixteen narrow registers hold the lanes of two octaves, no more.
  for (int j = 0; j < octaves; j += 2) {
    AddOctaves<Two>(x, lags + j, octaves - j < 2 ? 1 : 2, n, sums + j);
  }
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void AddAvx2(const double* x, const double* const* lags, int octaves,
                                     std::int64_t n, double* sums) {
  for (int j = 0; j < octaves; j += 4) {
    AddOctaves<Four>(x, lags + j, octaves - j < 4 ? octaves - j : 4, n, sums + j);
  }
}

[[gnu::target("avx2")]] void PlaceAvx2(const double* sums, std::int64_t n, double before,
                                       double low, double high, double* local, double* phases) {
  Place(sums, n, before, low, high, local, phases);
}

[[gnu::target("avx512f")]] void AddAvx512(const double* x, const double* const* lags, int octaves,
                                          std::int64_t n, double* sums) {
  AddOctaves<Eight>(x, lags, octaves, n, sums);
}
#endif

}  // namespace

Simd WidestSimd() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return Simd::kAvx512;
  if (__builtin_cpu_supports("avx2")) return Simd::kAvx2;
#endif
  return Simd::kPlain;
}

void AddSquaredDifferences(Simd simd, const double* x, const double* const* lags, int octaves,
                           std::int64_t n, double* sums) {
#if defined(__x86_64__)
  if (simd == Simd::kAvx512) return AddAvx512(x, lags, octaves, n, sums);
  if (simd == Simd::kAvx2) return AddAvx2(x, lags, octaves, n, sums);
#endif
  static_cast<void>(simd);
  AddPlain(x, lags, octaves, n, sums);
}

void PlacePhases(Simd simd, const double* sums, std::int64_t n, double before, double low,
                 double high, double* local, double* phases) {
#if defined(__x86_64__)
  if (simd != Simd::kPlain) return PlaceAvx2(sums, n, before, low, high, local, phases);
#endif
  static_cast<void>(simd);
  Place(sums, n, before, low, high, local, phases);
}

}  // namespace wellgyro
