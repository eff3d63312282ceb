#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/grid.h"

namespace wellgyro {
namespace {

// By hand: declination 3 east, convergence 1: 10 magnetic is 13 true is 12 grid.
const AzimuthReference kReference{
    .north = North::kMagnetic, .convergence = FromDegrees(1), .declination = FromDegrees(3)};

double Turned(double degrees, North from, North to) {
  return ToDegrees(AzimuthFrom(kReference, FromDegrees(degrees), from, to));
}

TEST(AzimuthFrom, TrueIsGridPlusConvergenceIsMagneticPlusDeclination) {
  EXPECT_NEAR(Turned(10, North::kMagnetic, North::kTrue), 13, 1e-12);
  EXPECT_NEAR(Turned(10, North::kMagnetic, North::kGrid), 12, 1e-12);
  EXPECT_NEAR(Turned(12, North::kGrid, North::kMagnetic), 10, 1e-12);
  EXPECT_NEAR(Turned(0.5, North::kTrue, North::kGrid), 359.5, 1e-12);
  EXPECT_NEAR(Turned(-90, North::kTrue, North::kTrue), 270, 1e-12);
}

TEST(AzimuthFrom, WhatIsNotFiniteIsRefusedOrStays) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  AzimuthReference reference;
  reference.convergence = kNan;
  reference.declination = std::numeric_limits<double>::infinity();
  EXPECT_THROW(AzimuthFrom(reference, 1, North::kTrue, North::kGrid), std::invalid_argument);
  EXPECT_THROW(AzimuthFrom(reference, 1, North::kMagnetic, North::kTrue), std::invalid_argument);
  EXPECT_TRUE(std::isnan(AzimuthFrom(reference, kNan, North::kTrue, North::kTrue)));
}

TEST(AzimuthFrom, SaysWhatIsMissing) {
  const AzimuthReference none{};
  const auto message = [&](North from, North to) {
    try {
      AzimuthFrom(none, 1, from, to);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("turned");
  };
  EXPECT_THAT(message(North::kTrue, North::kGrid), testing::HasSubstr("convergence"));
  EXPECT_THAT(message(North::kMagnetic, North::kTrue), testing::HasSubstr("declination"));
  EXPECT_THAT(message(North::kUnknown, North::kUnknown), testing::HasSubstr("which north"));
  EXPECT_EQ(message(North::kGrid, North::kGrid), "turned");
}

}  // namespace
}  // namespace wellgyro
