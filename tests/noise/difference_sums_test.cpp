#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/math/random.h"
#include "wellgyro/noise/difference_sums_internal.h"

namespace wellgyro {
namespace {

// The same log gives the same bytes on every processor.
TEST(DifferenceSums, EveryWidthGivesTheSameBits) {
  std::vector<double> x(8000);
  Random random(3);
  for (std::size_t i = 1; i < x.size(); ++i) x[i] = x[i - 1] + random.Normal();
  for (int octaves = 1; octaves <= kChainMax; ++octaves) {
    for (const std::int64_t n : {0, 1, 7, 8, 9, 100, 2048}) {
      std::array<const double*, kChainMax + 1> lags{};
      for (std::size_t j = 0; j < lags.size(); ++j) lags[j] = x.data() + 5000 - (17u << j);
      std::array<double, kChainMax> plain{};
      AddSquaredDifferences(Simd::kPlain, x.data() + 5000, lags.data(), octaves, n, plain.data());
      for (int j = 0; j < octaves; ++j) {
        double sum = 0;
        for (std::int64_t i = 0; i < n; ++i) {
          const double d = x[static_cast<std::size_t>(5000 + i)] -
                           2 * lags[static_cast<std::size_t>(j)][i] +
                           lags[static_cast<std::size_t>(j) + 1][i];
          sum += d * d;
        }
        EXPECT_NEAR(plain[static_cast<std::size_t>(j)], sum, 1e-12 * sum);
      }
      for (const Simd simd : {Simd::kAvx2, Simd::kAvx512}) {
        if (simd > WidestSimd()) continue;
        std::array<double, kChainMax> wide{};
        AddSquaredDifferences(simd, x.data() + 5000, lags.data(), octaves, n, wide.data());
        EXPECT_EQ(plain, wide) << octaves << " " << n;
      }
    }
  }
}

}  // namespace
}  // namespace wellgyro
