#include "wellgyro/earth/magnetic.h"

#include <cmath>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

constexpr char kFolder[] = WELLGYRO_DATA_DIR "/magnetic";

Result<MagneticField> At(const char* model, double year, double km, double latitude,
                         double longitude) {
  return MagneticFieldAt(model, kFolder, {latitude * units::kDeg, longitude * units::kDeg},
                         1000 * km, year);
}

// Rows of the test values that NOAA NCEI publishes with the World Magnetic Model 2025
// (WMM2025_TEST_VALUES.txt, December 2024): year, height [km], latitude, longitude [deg],
// declination, dip [deg], H, F [nT].
TEST(MagneticField, PublishedValuesOfWmm2025) {
  constexpr double kRows[][8] = {
      {2025.0, 28, 89, -121, -99.77, 88.47, 1504.298146, 56214.419888},
      {2025.0, 65, 43, 93, 0.50, 64.10, 24300.764692, 55626.621348},
      {2025.0, 51, -33, 109, -5.49, -67.50, 21838.046477, 57054.752538},
      {2025.5, 6, -36, -137, 20.28, -52.11, 25353.230658, 41280.516301},
      {2025.5, 8, -66, 17, -33.14, -59.55, 18154.870136, 35822.382382},
      {2026.0, 74, -57, 3, -22.51, -58.65, 14362.206593, 27606.226129},
      {2026.0, 62, -14, 99, -1.43, -44.70, 33448.275663, 47058.03012},
      {2026.5, 14, 0, 80, -3.10, -17.15, 39489.089663, 41327.424134},
      {2027.0, 37, -66, -5, -17.22, -59.04, 17159.8365, 33360.029814},
      {2027.5, 73, -72, 95, -102.64, -76.49, 13306.747292, 56974.931751},
  };
  for (const auto& row : kRows) {
    const auto found = At("wmm2025", row[0], row[1], row[2], row[3]);
    ASSERT_TRUE(found) << found.fault().text;
    // Rounded to 0.01 deg; 1e-3 nT is what the rounding of the height above the sphere leaves.
    EXPECT_NEAR(found->declination / units::kDeg, row[4], 0.005 + 1e-9) << row[2];
    EXPECT_NEAR(found->dip / units::kDeg, row[5], 0.005 + 1e-9) << row[2];
    EXPECT_NEAR(found->field / units::kNanotesla, row[7], 1e-3) << row[2];
    EXPECT_NEAR(found->field * std::cos(found->dip) / units::kNanotesla, row[6], 1e-3) << row[2];
  }
}

// Both describe one field: they agree within what either is sure of, and the older model too.
TEST(MagneticField, ModelsAgree) {
  for (const double latitude : {-60.0, -20.0, 10.0, 58.0}) {
    const auto wmm = At("wmm2025", 2026, 0, latitude, 2), igrf = At("igrf14", 2026, 0, latitude, 2);
    ASSERT_TRUE(wmm && igrf);
    EXPECT_NEAR(wmm->declination, igrf->declination, wmm->sigma_declination);
    EXPECT_NEAR(wmm->dip, igrf->dip, wmm->sigma_dip);
    EXPECT_NEAR(wmm->field, igrf->field, wmm->sigma_field);
    // 0.26 deg and 5417 nT over the horizontal field.
    const double horizontal = wmm->field * std::cos(wmm->dip) / units::kNanotesla;
    EXPECT_NEAR(wmm->sigma_declination / units::kDeg, std::hypot(0.26, 5417 / horizontal), 1e-9);
  }
  // Where one model hands over to the next they differ by what five years have taught.
  const auto old = At("wmm2020", 2024.99, 0, 58, 2), now = At("wmm2025", 2025, 0, 58, 2);
  ASSERT_TRUE(old && now);
  EXPECT_NEAR(old->declination, now->declination, 0.2 * units::kDeg);
}

TEST(MagneticField, RefusesWhatItCannotSay) {
  EXPECT_EQ(At("wmm2025", 2024.9, 0, 58, 2).fault().code, FaultCode::kRange);
  EXPECT_EQ(At("wmm2025", 2030.1, 0, 58, 2).fault().code, FaultCode::kRange);
  EXPECT_EQ(At("wmm2025", 2026, 700, 58, 2).fault().code, FaultCode::kRange);
  EXPECT_EQ(At("wmm2025", 2026, 0, 91, 2).fault().code, FaultCode::kRange);
  EXPECT_EQ(At("wmm2025", NAN, 0, 58, 2).fault().code, FaultCode::kRange);
  EXPECT_EQ(At("nothing", 2026, 0, 58, 2).fault().code, FaultCode::kIo);
  EXPECT_EQ(At("../magnetic/wmm2025", 2026, 0, 58, 2).fault().code, FaultCode::kRange);
}

TEST(DecimalYear, CountsDays) {
  EXPECT_EQ(DecimalYear("2025-01-01").value(), 2025);
  EXPECT_NEAR(DecimalYear("2024-12-31").value(), 2024 + 365.0 / 366, 1e-12);
  EXPECT_NEAR(DecimalYear("2026-11-22").value(), 2026 + 325.0 / 365, 1e-12);
  EXPECT_NEAR(DecimalYear("2024-03-01").value(), 2024 + 60.0 / 366, 1e-12);
  for (const char* bad : {"2025-02-29", "2025-13-01", "2025-00-10", "2025-1-1", "20250101", "",
                          "2025-06-31", "2025/06/01", "2025-06-01x", "abcd-ef-gh"}) {
    EXPECT_FALSE(DecimalYear(bad)) << bad;
  }
}

}  // namespace
}  // namespace wellgyro
