#pragma once

#include <cstdint>

namespace wellgyro {

/// How wide the processor works. The result does not depend on it, bit for bit.
enum class Simd { kPlain, kAvx2, kAvx512 };

/// The widest that this processor has.
Simd WidestSimd();

/// Most octaves that one call of AddSquaredDifferences takes.
inline constexpr int kChainMax = 8;

/// sums[j] += sum over i < n of (x[i] - 2 lags[j][i] + lags[j+1][i])^2, j < octaves: the second
/// differences of octaves that share their lags, each of the octaves + 1 lags read once.
void AddSquaredDifferences(Simd simd, const double* x, const double* const* lags, int octaves,
                           std::int64_t n, double* sums);

/// local[i] = sums[i] + before and phases[i] = high + (low + local[i]), i < n.
void PlacePhases(Simd simd, const double* sums, std::int64_t n, double before, double low,
                 double high, double* local, double* phases);

}  // namespace wellgyro
