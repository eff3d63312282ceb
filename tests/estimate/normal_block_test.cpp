// What squares of residuals add up to under their losses.
#include "wellgyro/estimate/normal_block.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

/// E[min(s, 3 sqrt s)] / n for s the sum of squares of n standard normals: Simpson's rule over
/// their root, whose density is 2 r^(n-1) e^(-r^2/2) / (2^(n/2) Gamma(n/2)).
long double HuberByQuadrature(int n) {
  constexpr int kSteps = 20000;
  constexpr long double kEnd = 12;
  const long double h = kEnd / kSteps;
  const long double norm = 2 / (std::pow(2.0L, n / 2.0L) * std::tgamma(n / 2.0L));
  long double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const long double r = h * i;
    const long double value =
        std::min(r * r, 3 * r) * norm * std::pow(r, n - 1.0L) * std::exp(-r * r / 2);
    sum += value * (i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2);
  }
  return sum * h / 3 / n;
}

TEST(NormalBlock, ExpectsOfSquaresWhatHubersLossLeavesOfThem) {
  Layout layout;
  for (int n = 1; n <= 3; ++n) {
    NormalBlock block;
    block.Clear(layout);
    Factor f;
    f.Begin(RowKind::kForce, n);
    f.r.setConstant(0.5);
    f.Column(0).setConstant(1);
    block.Add(f);
    const RowSum& sum = block.sums()[static_cast<std::size_t>(RowKind::kForce)];
    EXPECT_NEAR(sum.expected / n, static_cast<double>(HuberByQuadrature(n)), 1e-9) << n;
    EXPECT_LT(sum.expected, n);
    EXPECT_NEAR(sum.weighted, 0.25 * n, 1e-15);
  }
}

}  // namespace
}  // namespace wellgyro
