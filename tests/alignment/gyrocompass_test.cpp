#include "wellgyro/alignment/gyrocompass.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

using units::kDeg;
using units::kDegPerHour;
using units::kDegPerHourPerG;

constexpr double kOmega = 7.292115e-5;

/// A tool at rest by the formulas of two transverse axes, not by matrices:
/// W e^{iT} = We (cL cA cI + sL sI) - i We cL sA.
struct Truth {
  double latitude = 60 * kDeg, inclination = 30 * kDeg, azimuth = 45 * kDeg;
  double seconds = 180;
  double gyro_noise = 0, accel_noise = 0;  ///< of a window's mean
  double bias_x = 0, bias_y = 0, bias_z = 0, m = 0, q = 0;
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  Eigen::Matrix3d accel_linear = Eigen::Matrix3d::Zero();  ///< scales, and axes that lean
  double gyro_roll = 0;  ///< of the gyros against the accelerometers
  bool gz = false;

  Site Place() const { return SiteAt(latitude, 0); }

  StillWindow Window(double toolface, double begin, Random& random) const {
    const double sL = std::sin(latitude), cL = std::cos(latitude);
    const double sI = std::sin(inclination), cI = std::cos(inclination);
    const double sA = std::sin(azimuth), cA = std::cos(azimuth);
    const double g = Place().gravity;
    const auto W = kOmega * std::complex(cL * cA * cI + sL * sI, -cL * sA) *
                   std::polar(1.0, -toolface - gyro_roll);
    const Eigen::Vector3d f(g * sI * std::cos(toolface), -g * sI * std::sin(toolface), -g * cI);
    StillWindow window;
    window.begin = {Duration::Seconds(begin).ns};
    window.end = {Duration::Seconds(begin + seconds).ns};
    window.samples = 100;
    window.has_gz = gz;
    window.w_IT_T = {W.real() + bias_x + m * f.x() + q * f.y(),
                     W.imag() + bias_y + m * f.y() - q * f.x(),
                     gz ? kOmega * (cL * cA * sI - sL * cI) + bias_z : 0};
    window.f_T = f + accel_bias + accel_linear * f;
    for (int i = 0; i < (gz ? 3 : 2); ++i) window.w_IT_T[i] += gyro_noise * random.Normal();
    for (int i = 0; i < 3; ++i) window.f_T[i] += accel_noise * random.Normal();
    window.sigma_w_IT_T = Eigen::Vector3d::Constant(gyro_noise);
    window.sigma_f_T = Eigen::Vector3d::Constant(accel_noise);
    return window;
  }

  std::vector<StillWindow> Windows(std::vector<double> toolfaces, Random& random) const {
    std::vector<StillWindow> windows;
    for (const double toolface : toolfaces) {
      windows.push_back(
          Window(toolface, (seconds + 30) * static_cast<double>(windows.size()), random));
    }
    return windows;
  }
};

double Sigma(const NorthFix& fix) { return std::sqrt(fix.cov_attitude(1, 1)); }

double Normalised(const NorthFix& fix, const Truth& truth, double toolface) {
  const Eigen::Vector3d error(fix.inclination - truth.inclination,
                              WrapPi(fix.azimuth - truth.azimuth), WrapPi(fix.toolface - toolface));
  return error.dot(fix.cov_attitude.inverse() * error);
}

/// Chi-square band of `n` draws of `dof` degrees at 99.9 %.
void ExpectInBand(double sum, double n, double dof, const std::string& what) {
  EXPECT_GT(sum, ChiSquareQuantile(0.0005, n * dof)) << what << ": " << sum / n / dof;
  EXPECT_LT(sum, ChiSquareQuantile(0.9995, n * dof)) << what << ": " << sum / n / dof;
}

TEST(Gyrocompass, ExactRatesGiveTheExactAttitude) {
  Random random(1);
  for (const double inclination : {0.5, 5.0, 30.0, 60.0, 89.0, 120.0, 170.0}) {
    for (const double azimuth : {0.0, 40.0, 130.0, 200.0, 301.0, 359.9}) {
      for (const double toolface : {0.0, 100.0, -170.0}) {
        for (const double latitude : {-50.0, 0.0, 70.0}) {
          for (const bool gz : {false, true}) {
            const Truth truth{.latitude = latitude * kDeg,
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
    const Truth truth{.latitude = c.latitude * kDeg,
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
    Truth exact = truth;
    exact.gyro_noise = 0;
    auto windows = exact.Windows({0.4}, random);
    windows[0].sigma_w_IT_T.setConstant(truth.gyro_noise);
    EXPECT_NEAR(Sigma(Gyrocompass(windows, truth.Place(), {})) / theory, 1, 2e-3);
  }
}

/// Draws a tool's errors by their priors and its place by the latitude's, then its windows.
NorthFix Draw(Truth truth, const ErrorPriors& errors, const std::vector<double>& toolfaces,
              Random& random) {
  const Site believed = SiteAt(truth.latitude + errors.latitude_sigma * random.Normal(), 0);
  truth.bias_x = errors.gyro_bias_sigma * random.Normal();
  truth.bias_y = errors.gyro_bias_sigma * random.Normal();
  truth.bias_z = errors.gyro_bias_sigma * random.Normal();
  truth.m = errors.mass_unbalance_sigma * random.Normal();
  truth.q = errors.quadrature_sigma * random.Normal();
  for (int i = 0; i < 3; ++i) truth.accel_bias[i] = errors.accel_bias_sigma * random.Normal();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double sigma = i == j ? errors.accel_scale_sigma : errors.accel_misalignment_sigma;
      truth.accel_linear(i, j) = sigma * random.Normal();
    }
  }
  // The frame is the accelerometers', which x and y lean out of alike.
  auto &xy = truth.accel_linear(0, 1), &yx = truth.accel_linear(1, 0);
  truth.gyro_roll = 0.5 * (xy - yx);
  xy = yx = 0.5 * (xy + yx);
  return Gyrocompass(truth.Windows(toolfaces, random), believed, {.errors = errors});
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
          const Truth truth{.latitude = 60 * kDeg,
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
    const Truth truth{.inclination = c.inclination * kDeg,
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
    Truth exact = truth;
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
    const Truth truth{.gyro_noise = 0.02 * kDegPerHour,
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
  const Truth truth{.gyro_noise = 0.02 * kDegPerHour};
  const NorthFix alone = Gyrocompass(truth.Windows({1}, random), truth.Place(),
                                     {.errors = {.gyro_bias_sigma = 0.3 * kDegPerHour}});
  EXPECT_FALSE(alone.gyro_bias.has_value());
}

TEST(Gyrocompass, BiasWithoutAPriorIsFreeWhereToolfacesSeparateIt) {
  Random random(6);
  const Truth truth{
      .gyro_noise = 0.02 * kDegPerHour, .bias_x = 3 * kDegPerHour, .bias_y = -2 * kDegPerHour};
  const NorthFix fix = Gyrocompass(truth.Windows({0.2, 0.2 + kPi}, random), truth.Place(), {});
  EXPECT_LT(std::abs(WrapPi(fix.azimuth - truth.azimuth)), 4 * Sigma(fix));
  EXPECT_LT(Sigma(fix), 0.2 * kDeg);
  const NorthFix alone = Gyrocompass(truth.Windows({0.2}, random), truth.Place(), {});
  EXPECT_GT(std::abs(WrapPi(alone.azimuth - truth.azimuth)), 4 * Sigma(alone));
}

TEST(Gyrocompass, NearVerticalTheAccelerometersOutweighTheGyros) {
  Random random(7);
  const Truth truth{.inclination = 1 * kDeg, .gyro_noise = 0.01 * kDegPerHour};
  const ErrorPriors errors{.accel_bias_sigma = 1e-4 * 9.81};
  const NorthFix fix = Gyrocompass(truth.Windows({1.2}, random), truth.Place(), {.errors = errors});
  // 0.1 mg at 1 degree: 1e-4 / sin(1 deg) = 0.328 deg, the gyros 0.076 deg.
  EXPECT_NEAR(ToDegrees(Sigma(fix)), 0.33, 0.02);
  EXPECT_FALSE(Has(fix.quality, Quality::kVertical));
}

// Near vertical an accelerometer that leans reads as much across as one with a bias; one that leans
// against the other turns the toolface too.
TEST(Gyrocompass, AccelerometersThatLeanCountNearVertical) {
  const ErrorPriors errors{
      .accel_bias_sigma = 5e-4, .accel_scale_sigma = 5e-5, .accel_misalignment_sigma = 1e-4};
  Random random(31);
  for (const double inclination : {0.1, 2.0}) {
    double sum = 0, tilt = 0;
    constexpr int kDraws = 400;
    for (int i = 0; i < kDraws; ++i) {
      const Truth truth{.inclination = inclination * kDeg,
                        .azimuth = kTwoPi * random.Uniform(),
                        .gyro_noise = 0.02 * kDegPerHour,
                        .accel_noise = 1e-5};
      const NorthFix fix = Draw(truth, errors, {0.7}, random);
      tilt += std::pow(fix.inclination - truth.inclination, 2) / fix.cov_attitude(0, 0);
      sum += Normalised(fix, truth, 0.7);
      // 5e-4 of 9.82 m/s^2 and 1e-4 rad.
      EXPECT_NEAR(std::sqrt(fix.cov_attitude(0, 0)), 1.122e-4, 4e-6);
    }
    ExpectInBand(tilt, kDraws, 1, "inclination");
    ExpectInBand(sum, kDraws, 3, "all angles");
  }
}

// At the vertical azimuth and toolface are not defined, their sum is.
TEST(Gyrocompass, VerticalKeepsTheSumOfAzimuthAndToolface) {
  const ErrorPriors errors{.accel_bias_sigma = 5e-4};
  for (const double inclination : {0.0, 0.001, 179.999}) {
    Random random(8);
    double sum = 0, azimuth = 0;
    int vertical = 0;
    constexpr int kDraws = 300;
    for (int i = 0; i < kDraws; ++i) {
      const Truth truth{.inclination = inclination * kDeg,
                        .azimuth = 1.1,
                        .gyro_noise = 0.02 * kDegPerHour,
                        .accel_noise = 1e-5};
      const NorthFix fix = Draw(truth, errors, {0.7}, random);
      vertical += Has(fix.quality, Quality::kVertical) ? 1 : 0;
      azimuth += fix.cov_attitude(1, 1) / kDraws;
      EXPECT_LE(fix.cov_attitude(1, 1), kPi * kPi / 3 + 1e-12);
      const double sign = inclination < 90 ? 1 : -1;
      const double variance =
          fix.cov_attitude(1, 1) + fix.cov_attitude(2, 2) + 2 * sign * fix.cov_attitude(1, 2);
      EXPECT_NEAR(std::sqrt(variance), 0.02 / 7.52, 0.0005);
      const double error = WrapPi(fix.azimuth + sign * fix.toolface - (1.1 + sign * 0.7));
      sum += error * error / variance;
    }
    ExpectInBand(sum, kDraws, 1, "azimuth + toolface");
    EXPECT_GT(vertical, 0.97 * kDraws);  // all but 1.1 % of tilts are within 3 sigma
    EXPECT_GT(azimuth, 2);               // of pi^2/3
  }
}

// At 80 degrees heading north-east the two axes hardly tell A from 180 deg - A.
TEST(Gyrocompass, TheMirrorIsKeptWhileTheDataDoNotExcludeIt) {
  Random random(9);
  Truth truth{.inclination = 89 * kDeg, .azimuth = 60 * kDeg, .gyro_noise = 0.05 * kDegPerHour};
  const NorthFix fix = Gyrocompass(truth.Windows({0.3}, random), truth.Place(), {});
  ASSERT_TRUE(fix.mirror_azimuth.has_value());
  EXPECT_TRUE(Has(fix.quality, Quality::kMirror));
  EXPECT_NEAR(WrapPi(fix.azimuth + *fix.mirror_azimuth - kPi), 0, 0.02);
  EXPECT_GE(fix.mirror_cost, 0);
  EXPECT_LT(fix.mirror_cost, 9);
  truth.gz = true;  // the third axis tells
  const NorthFix clear = Gyrocompass(truth.Windows({0.3}, random), truth.Place(), {});
  EXPECT_FALSE(clear.mirror_azimuth.has_value());
  EXPECT_NEAR(WrapPi(clear.azimuth - truth.azimuth), 0, 5 * Sigma(clear));
}

// East and horizontal: the cost is a quartic, the posterior some degrees wide. Exactly there the
// estimate is far better than it can know; over the azimuths about, it is as good as it says.
TEST(Gyrocompass, EastAndHorizontalIsSaidByTheCovariance) {
  Random random(10);
  for (const bool exact : {true, false}) {
    double sum = 0;
    constexpr int kDraws = 500;
    for (int i = 0; i < kDraws; ++i) {
      const Truth truth{.inclination = 90 * kDeg,
                        .azimuth = (exact ? 90 : 82 + 16 * random.Uniform()) * kDeg,
                        .gyro_noise = 0.02 * kDegPerHour};
      const NorthFix fix = Gyrocompass(truth.Windows({0.3}, random), truth.Place(), {});
      EXPECT_GT(ToDegrees(Sigma(fix)), 0.8);
      EXPECT_LT(ToDegrees(Sigma(fix)), 13);
      double error = std::abs(WrapPi(fix.azimuth - truth.azimuth));
      if (fix.mirror_azimuth) {
        error = std::min(error, std::abs(WrapPi(*fix.mirror_azimuth - truth.azimuth)));
      }
      sum += std::pow(error / Sigma(fix), 2);
    }
    EXPECT_LT(sum / kDraws, 1.2);
    if (!exact) {
      EXPECT_GT(sum / kDraws, 0.2);
    }
  }
}

// Azimuth and mirror between which the cost hardly rises are one candidate, whose sigma covers
// both: over all azimuths from which that comes, errors and sigma agree.
TEST(Gyrocompass, MirrorsThatHaveRunIntoOneAreOneCandidate) {
  const ErrorPriors errors{.gyro_bias_sigma = 0.1 * kDegPerHour};
  Random random(14);
  double sum = 0;
  int one = 0;
  for (int i = 0; i < 1000; ++i) {
    const Truth truth{.latitude = 60 * kDeg,
                      .inclination = 90 * kDeg,
                      .azimuth = (50 + 80 * random.Uniform()) * kDeg,
                      .gyro_noise = 0.02 * kDegPerHour};
    const NorthFix fix = Draw(truth, errors, {0.3}, random);
    if (fix.mirror_azimuth) {
      EXPECT_GT(std::abs(WrapPi(*fix.mirror_azimuth - fix.azimuth)), 5 * Sigma(fix));
      continue;
    }
    ++one;
    EXPECT_NEAR(fix.azimuth, 90 * kDeg, 0.1 * kDeg);
    sum += std::pow(WrapPi(fix.azimuth - truth.azimuth) / Sigma(fix), 2);
  }
  EXPECT_GT(one, 200);
  ExpectInBand(sum, one, 1, "one candidate");
}

TEST(Gyrocompass, BiasInstabilityIsAFloorThatNoLongWindowPasses) {
  Random random(11);
  Truth truth{.gyro_noise = 1e-4 * kDegPerHour};
  NoiseCoefficients gyro{.bias_instability = 0.05 * kDegPerHour};
  const auto sigma = [&](std::vector<double> toolfaces) {
    return ToDegrees(
        Sigma(Gyrocompass(truth.Windows(toolfaces, random), truth.Place(), {.gyro = gyro})));
  };
  const double constant = sigma({0.3}), paired = sigma({0.3, 0.3 + kPi});
  EXPECT_NEAR(constant, 0.05 / 7.52 / kDeg * std::sqrt(1 / (0.5 + 0.5 * 0.75)), 0.01);
  EXPECT_LT(paired, 0.01 * constant) << "a constant cancels";
  gyro.bias_instability_correlation_time = 600;
  EXPECT_NEAR(sigma({0.3}), 1.075 * constant, 0.01);
  // exp(-210/600) = 0.705 of it cancels.
  EXPECT_NEAR(sigma({0.3, 0.3 + kPi}), 1.075 * constant * std::sqrt((1 - 0.705) / 2), 0.01);
}

TEST(Gyrocompass, GravityAndEarthRateAreCheckedAgainstTheirOwnSigma) {
  Random random(12);
  Truth truth{.gyro_noise = 0.02 * kDegPerHour, .accel_noise = 1e-4};
  const auto quality = [&](const Truth& t) {
    return Gyrocompass(t.Windows({0.3}, random), truth.Place(), {}).quality;
  };
  EXPECT_EQ(quality(truth), Quality::kGood);
  Truth heavy = truth;
  heavy.accel_bias = {0, 0, -0.01};
  EXPECT_TRUE(Has(quality(heavy), Quality::kGravity));
  Truth biased = truth;
  biased.bias_x = 0.5 * kDegPerHour;
  EXPECT_TRUE(Has(quality(biased), Quality::kEarthRate));
  EXPECT_FALSE(Has(quality(biased), Quality::kGravity));
}

// Biases, scales and misalignments of the accelerometers and gravity itself, at one toolface and at
// three, where part of them cancels.
TEST(Gyrocompass, GravityIsOffAsItsSigmaSays) {
  Random random(21);
  const ErrorPriors errors{
      .accel_bias_sigma = 5e-4, .accel_scale_sigma = 7e-5, .accel_misalignment_sigma = 1.5e-4};
  const auto three = [&random](double sigma) {
    return Eigen::Vector3d{sigma * random.Normal(), sigma * random.Normal(),
                           sigma * random.Normal()};
  };
  constexpr int kTools = 400;
  for (const std::vector<double>& toolfaces : {std::vector{0.7}, {0.7, 2.0, 4.5}}) {
    double squares = 0;
    for (int tool = 0; tool < kTools; ++tool) {
      const Truth truth{
          .inclination = kPi * random.Uniform(), .gyro_noise = 1e-7, .accel_noise = 3e-4};
      std::vector<StillWindow> windows = truth.Windows(toolfaces, random);
      Eigen::Matrix3d A;
      A << three(1.5e-4), three(1.5e-4), three(1.5e-4);
      A.diagonal() = three(7e-5);
      const Eigen::Vector3d bias = three(5e-4);
      for (StillWindow& window : windows) window.f_T += (A * window.f_T).eval() + bias;
      Site place = truth.Place();
      place.gravity += 5e-4 * random.Normal();
      const NorthFix fix = Gyrocompass(windows, place, {.errors = errors});
      squares += std::pow((fix.gravity - fix.gravity_ref) / fix.sigma_gravity, 2);
    }
    EXPECT_GT(squares, ChiSquareQuantile(5e-4, kTools)) << toolfaces.size();
    EXPECT_LT(squares, ChiSquareQuantile(1 - 5e-4, kTools)) << toolfaces.size();
  }
}

TEST(Gyrocompass, TheFixCarriesItsWindows) {
  Random random(13);
  const Truth truth{.gyro_noise = 0.02 * kDegPerHour, .accel_noise = 1e-4};
  auto windows = truth.Windows({0.3, 2.0}, random);
  windows[0].seq_begin = 500;
  windows[1].seq_end = 900;
  windows[1].md = 1234.5;
  windows[0].quality = Quality::kSaturated;
  const NorthFix fix = Gyrocompass(windows, truth.Place(), {});
  EXPECT_EQ(fix.seq_begin, 500);
  EXPECT_EQ(fix.seq_end, 900);
  EXPECT_EQ(fix.md, 1234.5);
  EXPECT_EQ(fix.begin, windows[0].begin);
  EXPECT_EQ(fix.end, windows[1].end);
  EXPECT_TRUE(fix.from_samples);
  EXPECT_FALSE(fix.external);
  EXPECT_TRUE(Has(fix.quality, Quality::kSaturated));
  EXPECT_NEAR(WrapPi(fix.toolface - 2), 0, 1e-3);
}

TEST(Gyrocompass, RefusesWhatIsNoWindow) {
  Random random(14);
  const Truth truth;
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

// Two gyros that see two and three thousandths of the axial rate: known, it takes nothing off the
// azimuth; unknown, some of it.
TEST(Gyrocompass, WhatIsKnownOfTheAxialRateIsNoError) {
  Random random(16);
  const Truth truth{.inclination = 70 * kDeg, .azimuth = 40 * kDeg};
  auto windows = truth.Windows({20 * kDeg}, random);
  const double sL = std::sin(truth.latitude), cL = std::cos(truth.latitude);
  const double axial = kOmega * (cL * std::cos(truth.azimuth) * std::sin(truth.inclination) -
                                 sL * std::cos(truth.inclination));
  windows[0].w_IT_T += Eigen::Vector3d(2e-3 * axial, -3e-3 * axial, 0);
  GyrocompassSetup setup;
  const double off = WrapPi(Gyrocompass(windows, truth.Place(), setup).azimuth - truth.azimuth);
  EXPECT_GT(std::abs(off), 1e-4);
  setup.errors.gyro_misalignment_x = 2e-3;
  setup.errors.gyro_misalignment_y = -3e-3;
  const NorthFix known = Gyrocompass(windows, truth.Place(), setup);
  EXPECT_NEAR(WrapPi(known.azimuth - truth.azimuth), 0, 1e-6);
}

// At the pole nothing tells north; the covariance is that of not knowing.
TEST(Gyrocompass, AtThePoleNorthIsUnknown) {
  Random random(15);
  const Truth truth{.latitude = 90 * kDeg, .gyro_noise = 0.02 * kDegPerHour, .accel_noise = 1e-4};
  const NorthFix fix = Gyrocompass(truth.Windows({0.3}, random), truth.Place(), {});
  EXPECT_NEAR(fix.cov_attitude(1, 1), kPi * kPi / 3, 0.1);
}

}  // namespace
}  // namespace wellgyro
