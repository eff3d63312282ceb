#include "wellgyro/alignment/gyrocompass.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"

#include "alignment/tool_at_rest.h"

namespace wellgyro {
namespace {

using test::Draw;
using test::ExpectInBand;
using test::kOmega;
using test::Normalised;
using test::Sigma;
using test::ToolAtRest;
using units::kDeg;
using units::kDegPerHour;
using units::kDegPerHourPerG;

TEST(Gyrocompass, ExactRatesGiveTheExactAttitude) {
  Random random(1);
  for (const double inclination : {0.5, 5.0, 30.0, 60.0, 89.0, 120.0, 170.0}) {
    for (const double azimuth : {0.0, 40.0, 130.0, 200.0, 301.0, 359.9}) {
      for (const double toolface : {0.0, 100.0, -170.0}) {
        for (const double latitude : {-50.0, 0.0, 70.0}) {
          for (const bool gz : {false, true}) {
            const ToolAtRest truth{.latitude = latitude * kDeg,
                                   .inclination = inclination * kDeg,
                                   .azimuth = azimuth * kDeg,
                                   .gz = gz};
            const auto windows = truth.Windows({toolface * kDeg}, random);
            const NorthFix fix = Gyrocompass(windows, truth.Place(), {});
            const std::string where = testing::PrintToString(
                std::vector<double>{inclination, azimuth, toolface, latitude});
            EXPECT_NEAR(WrapPi(fix.azimuth - truth.azimuth), 0, 1e-6) << where;
            EXPECT_NEAR(fix.inclination, truth.inclination, 1e-9) << where;
            EXPECT_NEAR(WrapPi(fix.toolface - toolface * kDeg), 0, 1e-8) << where;
            ASSERT_TRUE(fix.earth_rate.has_value()) << where;
            EXPECT_NEAR(*fix.earth_rate / kOmega, 1, 1e-5) << where;
          }
        }
      }
    }
  }
}

// sigma = s / (We cL sqrt(cos^2 A + sin^2 A cos^2 I)): least squares with the known Earth rate,
// where atan2 would give s / (We cL) sqrt(cos^2 A + sin^2 A / cos^2 I).
TEST(Gyrocompass, SigmaIsThatOfLeastSquaresAndTheErrorsHaveIt) {
  struct Case {
    double latitude, inclination, azimuth;
  };
  for (const auto& c : {Case{60, 30, 45}, Case{60, 60, 45}, Case{60, 80, 45}, Case{60, 90, 45},
                        Case{72, 80, 45}, Case{80, 30, 45}}) {
    const ToolAtRest truth{.latitude = c.latitude * kDeg,
                           .inclination = c.inclination * kDeg,
                           .azimuth = c.azimuth * kDeg,
                           .gyro_noise = 0.02 * kDegPerHour};
    const double cA = std::cos(truth.azimuth), sA = std::sin(truth.azimuth);
    const double cI = std::cos(truth.inclination);
    const double theory = truth.gyro_noise / (kOmega * std::cos(truth.latitude)) /
                          std::sqrt(cA * cA + sA * sA * cI * cI);
    Random random(2);
    double sum = 0;
    constexpr int kDraws = 1000;
    for (int i = 0; i < kDraws; ++i) {
      const NorthFix fix = Gyrocompass(truth.Windows({0.4}, random), truth.Place(), {});
      EXPECT_NEAR(Sigma(fix) / theory, 1, 0.05);
      double error = std::abs(WrapPi(fix.azimuth - truth.azimuth));
      // Horizontal the mirror is as good.
      if (fix.mirror_azimuth) {
        error = std::min(error, std::abs(WrapPi(*fix.mirror_azimuth - truth.azimuth)));
      }
      sum += std::pow(error / Sigma(fix), 2);
    }
    ExpectInBand(sum, kDraws, 1, testing::PrintToString(std::vector{c.latitude, c.inclination}));
    ToolAtRest exact = truth;
    exact.gyro_noise = 0;
    auto windows = exact.Windows({0.4}, random);
    windows[0].sigma_w_IT_T.setConstant(truth.gyro_noise);
    EXPECT_NEAR(Sigma(Gyrocompass(windows, truth.Place(), {})) / theory, 1, 2e-3);
  }
}

// The covariance of all three angles against errors drawn from the priors, over attitudes, number
// of axes and index positions. Where the mirror was chosen or is near the error is not Gaussian,
// and the fix says so: those are left out, and may not be many.
TEST(Gyrocompass, CovarianceHoldsWhatThePriorsAndTheNoiseDo) {
  const ErrorPriors errors{.gyro_bias_sigma = 0.1 * kDegPerHour,
                           .mass_unbalance_sigma = 0.1 * kDegPerHourPerG,
                           .quadrature_sigma = 0.1 * kDegPerHourPerG,
                           .accel_bias_sigma = 5e-4,
                           .accel_scale_sigma = 2e-4,
                           .accel_misalignment_sigma = 3e-4,
                           .latitude_sigma = 0.05 * kDeg};
  Random random(3);
  for (const bool gz : {false, true}) {
    for (const int positions : {1, 2, 4}) {
      double sum = 0, azimuth = 0, rate = 0;
      int used = 0, mirrors = 0, flags = 0;
      for (const double inclination : {5.0, 30.0, 60.0, 85.0, 120.0}) {
        for (int i = 0; i < 100; ++i) {
          const ToolAtRest truth{.latitude = 60 * kDeg,
                                 .inclination = inclination * kDeg,
                                 .azimuth = kTwoPi * random.Uniform(),
                                 .gyro_noise = 0.02 * kDegPerHour,
                                 .accel_noise = 1e-4,
                                 .gz = gz};
          std::vector<double> toolfaces;
          const double first = kTwoPi * random.Uniform();
          for (int k = 0; k < positions; ++k) toolfaces.push_back(first + kTwoPi * k / positions);
          const NorthFix fix = Draw(truth, errors, toolfaces, random);
          if (Has(fix.quality, Quality::kMirror)) {
            ++mirrors;
            continue;
          }
          ++used;
          sum += Normalised(fix, truth, toolfaces.back());
          azimuth += std::pow(WrapPi(fix.azimuth - truth.azimuth) / Sigma(fix), 2);
          if (fix.earth_rate)
            rate += std::pow((*fix.earth_rate - kOmega) / fix.sigma_earth_rate, 2);
          if (Has(fix.quality, Quality::kEarthRate)) ++flags;
        }
      }
      const std::string what = std::to_string(positions) + (gz ? " gz" : "");
      ExpectInBand(sum, used, 3, what);
      ExpectInBand(azimuth, used, 1, what + " azimuth");
      ExpectInBand(rate, used, 1, what + " rate");
      EXPECT_LT(mirrors, 120) << what;
      EXPECT_LE(flags, 6) << what;
    }
  }
}

// Indexing by 180 degrees takes out the biases, but neither mass unbalance nor quadrature, which
// turn with gravity as the Earth's rate does (bias, m, q 0.3 deg/h(/g), noise 0.02 deg/h, latitude
// 60, azimuth 40): rms azimuth of the notes' independent simulation, one and two positions.
TEST(Gyrocompass, IndexingCancelsBiasButNotWhatTurnsWithGravity) {
  struct Case {
    double inclination, one, two;
  };
  ErrorPriors errors{.gyro_bias_sigma = 0.3 * kDegPerHour,
                     .mass_unbalance_sigma = 0.3 * kDegPerHourPerG,
                     .quadrature_sigma = 0.3 * kDegPerHourPerG};
  Random random(4);
  for (const auto& c :
       {Case{2, 2.33, 0.142}, Case{15, 2.39, 0.600}, Case{30, 2.75, 1.22}, Case{60, 3.70, 2.27}}) {
    const ToolAtRest truth{.inclination = c.inclination * kDeg,
                           .azimuth = 40 * kDeg,
                           .gyro_noise = 0.02 * kDegPerHour};
    double one = 0, two = 0;
    constexpr int kDraws = 1000;
    for (int i = 0; i < kDraws; ++i) {
      const double toolface = kTwoPi * random.Uniform();
      one += std::pow(WrapPi(Draw(truth, errors, {toolface}, random).azimuth - truth.azimuth), 2);
      const auto fix = Draw(truth, errors, {toolface, toolface + kPi}, random);
      two += std::pow(WrapPi(fix.azimuth - truth.azimuth), 2);
    }
    // 1000 draws: rms to 2.2 % (1 sigma); the notes' figures are as good.
    EXPECT_NEAR(ToDegrees(std::sqrt(one / kDraws)) / c.one, 1, 0.1) << c.inclination;
    EXPECT_NEAR(ToDegrees(std::sqrt(two / kDraws)) / c.two, 1, 0.1) << c.inclination;
    // What the estimate itself says of the effect of the bias, without draws.
    ToolAtRest exact = truth;
    exact.gyro_noise = 1e-4 * kDegPerHour;
    const ErrorPriors bias{.gyro_bias_sigma = 0.3 * kDegPerHour};
    Random none(5);
    const double single =
        Sigma(Gyrocompass(exact.Windows({1}, none), exact.Place(), {.errors = bias}));
    const double paired =
        Sigma(Gyrocompass(exact.Windows({1, 1 + kPi}, none), exact.Place(), {.errors = bias}));
    EXPECT_GT(single, 2 * kDeg);
    EXPECT_LT(paired, 2e-3 * kDeg);
  }
}

// Whatever the prior, two positions tell the bias as their noise says.
TEST(Gyrocompass, IndexPositionsTellTheBiasWithoutItsPrior) {
  Random random(8);
  constexpr int kDraws = 300;
  double squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    const ToolAtRest truth{.gyro_noise = 0.02 * kDegPerHour,
                           .bias_x = 0.4 * kDegPerHour,
                           .bias_y = -0.1 * kDegPerHour};
    // A prior as narrow as the data: the posterior lies half way.
    const ErrorPriors errors{.gyro_bias_sigma = 0.015 * kDegPerHour};
    const NorthFix fix =
        Gyrocompass(truth.Windows({1, 1 + kPi}, random), truth.Place(), {.errors = errors});
    ASSERT_TRUE(fix.gyro_bias.has_value());
    EXPECT_NEAR(fix.sigma_gyro_bias.x(), 0.02 * kDegPerHour / std::sqrt(2), 1e-3 * kDegPerHour);
    const Eigen::Vector2d off = *fix.gyro_bias - Eigen::Vector2d(truth.bias_x, truth.bias_y);
    squares += off.cwiseQuotient(fix.sigma_gyro_bias).squaredNorm();
  }
  ExpectInBand(squares, kDraws, 2, "biases");
  const ToolAtRest truth{.gyro_noise = 0.02 * kDegPerHour};
  const NorthFix alone = Gyrocompass(truth.Windows({1}, random), truth.Place(),
                                     {.errors = {.gyro_bias_sigma = 0.3 * kDegPerHour}});
  EXPECT_FALSE(alone.gyro_bias.has_value());
}

TEST(Gyrocompass, BiasWithoutAPriorIsFreeWhereToolfacesSeparateIt) {
  Random random(6);
  const ToolAtRest truth{
      .gyro_noise = 0.02 * kDegPerHour, .bias_x = 3 * kDegPerHour, .bias_y = -2 * kDegPerHour};
  const NorthFix fix = Gyrocompass(truth.Windows({0.2, 0.2 + kPi}, random), truth.Place(), {});
  EXPECT_LT(std::abs(WrapPi(fix.azimuth - truth.azimuth)), 4 * Sigma(fix));
  EXPECT_LT(Sigma(fix), 0.2 * kDeg);
  const NorthFix alone = Gyrocompass(truth.Windows({0.2}, random), truth.Place(), {});
  EXPECT_GT(std::abs(WrapPi(alone.azimuth - truth.azimuth)), 4 * Sigma(alone));
}

TEST(Gyrocompass, TheMostRollIsOfSoManyWindows) {
  Random random(15);
  const ToolAtRest truth{.gyro_noise = 0.02 * kDegPerHour};
  auto windows = truth.Windows({0, kPi / 2, kPi, -kPi / 2}, random);
  const auto rolls = [&](std::size_t k, double rate, double sigma) {
    windows[k].roll_rate = rate;
    windows[k].sigma_roll_rate = sigma;
  };
  EXPECT_FALSE(Gyrocompass(windows, truth.Place(), {}).roll_rate.has_value());
  rolls(0, 3, 2);
  rolls(1, -2, 1);
  rolls(3, 4, 3);
  const NorthFix fix = Gyrocompass(windows, truth.Place(), {});
  EXPECT_EQ(fix.roll_rate.value_or(0), -2);
  EXPECT_EQ(fix.sigma_roll_rate, 1);
  EXPECT_EQ(fix.roll_windows, 3);
}

TEST(Gyrocompass, RefusesWhatIsNoWindow) {
  Random random(14);
  const ToolAtRest truth;
  const auto good = truth.Windows({0.3}, random);
  const auto refuses = [&](auto change) {
    auto windows = good;
    change(windows[0]);
    EXPECT_THROW(Gyrocompass(windows, truth.Place(), {}), std::invalid_argument);
  };
  EXPECT_THROW(Gyrocompass({}, truth.Place(), {}), std::invalid_argument);
  refuses([](StillWindow& w) { w.w_IT_T[0] = std::numeric_limits<double>::infinity(); });
  refuses([](StillWindow& w) { w.f_T.setZero(); });
  refuses([](StillWindow& w) { w.end = w.begin; });
  Site nowhere = truth.Place();
  nowhere.latitude = 2;
  EXPECT_THROW(Gyrocompass(good, nowhere, {}), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro
