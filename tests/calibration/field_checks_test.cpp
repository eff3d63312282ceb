#include "wellgyro/calibration/field_checks.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

constexpr double kLatitude = 58 * units::kDeg;

// At rest, by the components of high side, right side and axis.
StillWindow Window(double inclination, double azimuth, double toolface, bool has_gz) {
  const double ci = std::cos(inclination), si = std::sin(inclination);
  const double ca = std::cos(azimuth), sa = std::sin(azimuth);
  const double ct = std::cos(toolface), st = std::sin(toolface);
  const auto in_tool = [&](double n, double e, double d) {
    const double high = ci * ca * n + ci * sa * e - si * d, right = -sa * n + ca * e;
    const double along = si * ca * n + si * sa * e + ci * d;
    return Eigen::Vector3d(ct * high + st * right, -st * high + ct * right, along);
  };
  StillWindow window;
  window.samples = 6000;
  window.end.ns = 60'000'000'000;
  window.w_IT_T = in_tool(kEarthRate * std::cos(kLatitude), 0, -kEarthRate * std::sin(kLatitude));
  window.f_T = in_tool(0, 0, -9.81);
  window.b_T = in_tool(50e-6 * std::cos(1.2), 0, 50e-6 * std::sin(1.2));
  window.has_gz = has_gz;
  if (!has_gz) window.w_IT_T.z() = 0;
  window.has_mag = true;
  window.sigma_w_IT_T.setConstant(0.05 * units::kDegPerHour);
  window.sigma_f_T.setConstant(1e-4);
  return window;
}

FieldCheckSetup HouseSetup() {
  FieldCheckSetup setup;
  setup.reference = {.gravity = 9.81, .latitude = kLatitude, .field = 50e-6, .dip = 1.2};
  return setup;
}

const Check& Find(const std::vector<Check>& checks, const std::string& code) {
  for (const Check& check : checks) {
    if (check.code == code) return check;
  }
  ADD_FAILURE() << "no " << code;
  return checks.front();
}

TEST(FieldChecks, PassOnATrueWindowWhereverItLies) {
  for (const bool has_gz : {false, true}) {
    for (const double inc : {0.0, 1e-3, 0.4, 1.2, kPi / 2, 2.0}) {
      for (const double azimuth : {0.0, 0.7, kPi / 2, 3.0, 5.0}) {
        const auto checks = CheckWindow(Window(inc, azimuth, 1.0, has_gz), HouseSetup());
        for (const Check& check : checks) {
          if (check.code == "parity") {
            EXPECT_EQ(check.verdict, Verdict::kNotDone);
            continue;
          }
          EXPECT_EQ(check.verdict, Verdict::kPass) << check.code << inc << azimuth;
          EXPECT_NEAR(*check.value, 0, 1e-6 * *check.sigma + 1e-12) << check.code << inc;
          EXPECT_GT(*check.sigma, 0);
        }
        EXPECT_EQ(checks.size(), has_gz ? 7u : 5u);
      }
    }
  }
}

TEST(FieldChecks, TwoAxesSeeTheHorizontalRateNearVerticalAndTheVerticalOneNearHorizontal) {
  const double level = kEarthRate * std::cos(kLatitude);
  StillWindow vertical = Window(1e-6, 0.5, 0.3, false);
  vertical.w_IT_T.head<2>() *= 1.02;
  EXPECT_NEAR(*Find(CheckWindow(vertical, HouseSetup()), "earth_rate").value,
              0.02 * level / units::kDegPerHour, 1e-5);
  // Horizontal: a rate about the high side is vertical.
  StillWindow horizontal = Window(kPi / 2, 0.5, 0, false);
  horizontal.w_IT_T.x() += 0.3 * units::kDegPerHour;
  EXPECT_NEAR(*Find(CheckWindow(horizontal, HouseSetup()), "earth_rate").value, 0.3, 1e-6);
  // One about the right side looks like another azimuth.
  horizontal = Window(kPi / 2, 0.5, 0, false);
  horizontal.w_IT_T.y() += 0.3 * units::kDegPerHour;
  EXPECT_NEAR(*Find(CheckWindow(horizontal, HouseSetup()), "earth_rate").value, 0, 1e-6);
}

TEST(FieldChecks, EachFailsOnItsOwnError) {
  const auto verdict = [](const StillWindow& window, const FieldCheckSetup& setup,
                          const std::string& code) {
    return Find(CheckWindow(window, setup), code).verdict;
  };
  StillWindow window = Window(0.7, 1, 2, true);
  window.f_T *= 1 + 1.2e-4;  // 1.2e-3 against 5.1e-4: between two and three sigmas
  EXPECT_EQ(verdict(window, HouseSetup(), "gravity"), Verdict::kWarn);
  window.f_T *= 1 + 1e-3;
  EXPECT_EQ(verdict(window, HouseSetup(), "gravity"), Verdict::kFail);
  window = Window(0.7, 1, 2, true);
  window.w_IT_T += 1 * units::kDegPerHour * window.f_T.normalized();
  EXPECT_EQ(verdict(window, HouseSetup(), "earth_rate_vertical"), Verdict::kFail);
  EXPECT_EQ(verdict(window, HouseSetup(), "earth_rate"), Verdict::kFail);
  EXPECT_EQ(verdict(window, HouseSetup(), "earth_rate_horizontal"), Verdict::kPass);
  const Eigen::Vector3d up = window.f_T.normalized();
  StillWindow turned = Window(0.7, 1, 2, true);
  turned.w_IT_T *= 1.5;
  turned.w_IT_T -= 0.5 * kEarthRate * std::sin(kLatitude) * up;
  EXPECT_EQ(verdict(turned, HouseSetup(), "earth_rate_vertical"), Verdict::kPass);
  EXPECT_EQ(verdict(turned, HouseSetup(), "earth_rate_horizontal"), Verdict::kFail);
  FieldCheckSetup loose = HouseSetup();
  loose.errors.gyro_bias_sigma = 1 * units::kDegPerHour;
  EXPECT_EQ(verdict(window, loose, "earth_rate"), Verdict::kPass);
  window = Window(0.7, 1, 2, true);
  window.b_T *= 1.01;
  EXPECT_EQ(verdict(window, HouseSetup(), "field"), Verdict::kFail);
  EXPECT_EQ(verdict(window, HouseSetup(), "dip"), Verdict::kPass);
  FieldCheckSetup setup = HouseSetup();
  setup.parity = FieldCheckSetup::Parity{0.1, 0.02};
  EXPECT_EQ(verdict(window, setup, "parity"), Verdict::kFail);
  window.f_T.setZero();
  EXPECT_EQ(verdict(window, setup, "gravity"), Verdict::kNotDone);
}

TEST(FieldChecks, SigmaOfTheEarthRateIsThatOfManyNoisyWindows) {
  for (const bool has_gz : {false, true}) {
    for (const double inc : {0.02, 0.8, 1.5}) {
      Random random(4);
      const StillWindow clean = Window(inc, 0.9, 0.4, has_gz);
      double square = 0;
      constexpr int kWindows = 2000;
      for (int i = 0; i < kWindows; ++i) {
        StillWindow window = clean;
        for (int axis = 0; axis < (has_gz ? 3 : 2); ++axis)
          window.w_IT_T[axis] += window.sigma_w_IT_T[axis] * random.Normal();
        const Check check = Find(CheckWindow(window, HouseSetup()), "earth_rate");
        square += std::pow(*check.value / *check.sigma, 2);
      }
      // 1 sigma of a mean square over so many: 3.2 %.
      EXPECT_NEAR(square / kWindows, 1, 0.12) << inc << has_gz;
    }
  }
}

TEST(FieldChecks, CalibrationDate) {
  ToolCalibration tool;
  const std::int64_t day = 86'400'000'000'000;
  EXPECT_EQ(CheckCalibrationDate(tool, {100 * day}).verdict, Verdict::kNotDone);
  tool.calibrated = UtcTime{50 * day};
  tool.expires = UtcTime{200 * day};
  EXPECT_EQ(CheckCalibrationDate(tool, {100 * day}).verdict, Verdict::kPass);
  EXPECT_EQ(CheckCalibrationDate(tool, {100 * day}).value, 100);
  EXPECT_EQ(CheckCalibrationDate(tool, {201 * day}).verdict, Verdict::kFail);
  const Check ahead = CheckCalibrationDate(tool, {10 * day});
  EXPECT_EQ(ahead.verdict, Verdict::kWarn);
  EXPECT_EQ(ahead.code, "calibration_date_ahead");  // it has not expired, and is not said to
  EXPECT_EQ(ahead.value, -40);
}

}  // namespace
}  // namespace wellgyro
