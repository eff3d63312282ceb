#include "wellgyro/record/products.h"

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

TEST(Products, StandInOneOrder) {
  const Eigen::Vector3d a(2, 3, 5);
  const VectorProducts q = ProductsOf(a);
  EXPECT_EQ(q, (VectorProducts() << 4, 9, 25, 6, 15, 10).finished());
  for (int p = 0; p < 6; ++p) {
    const int i = kFirstFactor[p], j = kSecondFactor[p];
    EXPECT_EQ(q[p], a[i] * a[j]) << p;
    EXPECT_EQ(PlaceOfProduct(i, j), p);
    EXPECT_EQ(PlaceOfProduct(j, i), p);
  }
}

}  // namespace
}  // namespace wellgyro
