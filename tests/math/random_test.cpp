#include "wellgyro/math/random.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

// State {1, 2, 3, 4} of the authors' own test gives 41943041 first; a seed reaches that state only
// by chance, so the words are compared with a second, independent writing of the algorithm.
struct Reference {
  std::uint64_t s[4];
  static std::uint64_t Rot(std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }
  std::uint64_t Next() {
    const std::uint64_t r = Rot(s[0] + s[3], 23) + s[0], t = s[1] << 17;
    s[2] ^= s[0], s[3] ^= s[1], s[1] ^= s[2], s[0] ^= s[3], s[2] ^= t, s[3] = Rot(s[3], 45);
    return r;
  }
};

TEST(Random, IsXoshiro256PlusPlusSeededBySplitMix) {
  Reference known{{1, 2, 3, 4}};
  EXPECT_EQ(known.Next(), 41943041u);
  EXPECT_EQ(known.Next(), 58720359u);
  // SplitMix64 of seed 0 begins with these words (Vigna's splitmix64.c).
  Reference zero{
      {0xe220a8397b1dcdafu, 0x6e789e6aa1b965f4u, 0x06c45d188009454fu, 0xf88bb8a8724c81ecu}};
  Random random(0);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(random.Bits(), zero.Next()) << i;
}

TEST(Random, NormalFillsItsQuantilesEvenly) {
  constexpr int kCells = 200;
  constexpr int kDraws = 2'000'000;
  Random random(20240607);
  std::array<int, kCells> cells{};
  for (int i = 0; i < kDraws; ++i) {
    const double p = NormalCdf(random.Normal());
    ++cells[static_cast<std::size_t>(std::min(kCells - 1, static_cast<int>(p * kCells)))];
  }
  const double expected = static_cast<double>(kDraws) / kCells;
  double chi2 = 0;
  for (const int n : cells) chi2 += (n - expected) * (n - expected) / expected;
  EXPECT_GT(chi2, ChiSquareQuantile(1e-4, kCells - 1));
  EXPECT_LT(chi2, ChiSquareQuantile(1 - 1e-4, kCells - 1));
}

TEST(Random, NormalHasTheRightTailsAndNoMemory) {
  constexpr int kDraws = 4'000'000;
  Random random(7);
  int beyond4 = 0;
  double sum4 = 0;
  double lag1 = 0;
  double last = random.Normal();
  for (int i = 0; i < kDraws; ++i) {
    const double z = random.Normal();
    beyond4 += std::abs(z) > 4;
    sum4 += z * z * z * z;
    lag1 += z * last;
    last = z;
  }
  const double expected = kDraws * 2 * NormalCdf(-4);  // 253.4
  EXPECT_NEAR(beyond4, expected, 4 * std::sqrt(expected));
  EXPECT_NEAR(sum4 / kDraws, 3, 4 * std::sqrt(96. / kDraws));
  EXPECT_NEAR(lag1 / kDraws, 0, 4 / std::sqrt(kDraws));
}

}  // namespace
}  // namespace wellgyro
