#include "wellgyro/attitude/vertical_filter.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/statistics.h"

#include "attitude/vertical_truth.h"

namespace wellgyro {
namespace {

using vertical_truth::AddErrors;
using vertical_truth::AlongAt;
using vertical_truth::AttitudeAt;
using vertical_truth::AzimuthAt;
using vertical_truth::Cell;
using vertical_truth::Crossing;
using vertical_truth::Errors;
using vertical_truth::ErrorsAt;
using vertical_truth::kCells;
using vertical_truth::Norway;
using vertical_truth::Pass;
using vertical_truth::Samples;
using vertical_truth::Tactical;

constexpr double kRate = 10;  // [Hz]

/// Flies through `samples`, the azimuth exactly known after the first second.
VerticalFilter Fly(const Crossing& crossing, const Errors& errors,
                   const std::vector<ImuSample>& samples) {
  VerticalFilter filter({errors.gyro, errors.priors});
  const Site site = Norway();
  double t = 0;
  for (const ImuSample& s : samples) {
    const double dt = 1e-9 * s.stamp.period_ns;
    filter.Push(s, AlongAt(crossing, t + dt / 2), site);
    const bool first = t < 1 - dt / 2 && t + dt >= 1 - dt / 2;
    t += dt;
    if (first) filter.SetAzimuth(AzimuthAt(crossing, t), 0);
  }
  return filter;
}

TEST(VerticalFilter, CrossesExactlyWithAPerfectTool) {
  for (const double rpm : {0.0, 3.0}) {
    for (const bool has_gz : {false, true}) {
      const Crossing c = Pass(rpm, 0.05);
      const VerticalFilter filter = Fly(c, Tactical(), Samples(c, Norway(), kRate, has_gz));
      const Eigen::Vector3d error = ErrorsAt(c, c.seconds, filter.attitude());
      // A hundredth of what the same tool's errors come to.
      EXPECT_LT(std::abs(ToDegrees(error[1])), 2e-3) << rpm << ' ' << has_gz;
      EXPECT_LT(std::abs(ToDegrees(error[0])), 2e-4) << rpm << ' ' << has_gz;
    }
  }
}

TEST(VerticalFilter, DoesNotDependOnTheSamplingRate) {
  const Crossing c = Pass(3, 0.2);
  std::array<AttitudeSample, 2> end;
  int i = 0;
  for (const double rate : {10.0, 50.0}) {
    end[i++] = Fly(c, Tactical(), Samples(c, Norway(), rate, false)).attitude();
  }
  EXPECT_LT(std::abs(ToDegrees(WrapPi(end[0].azimuth - end[1].azimuth))), 2e-3);
  EXPECT_NEAR(std::sqrt(end[0].cov_attitude(1, 1) / end[1].cov_attitude(1, 1)), 1, 0.1);
}

TEST(VerticalFilter, KeepsTheSumOfAzimuthAndToolfaceAtVertical) {
  // Half way, 0.002 deg from vertical, azimuth and toolface are anything; their sum is not.
  const Crossing c = Pass(0, 0.002);
  std::vector<ImuSample> samples = Samples(c, Norway(), kRate, false);
  AddErrors(Tactical(), 5, samples);
  samples.resize(samples.size() / 2);
  const AttitudeSample a = Fly(c, Tactical(), samples).attitude();
  EXPECT_GT(std::sqrt(a.cov_attitude(1, 1)), FromDegrees(30));
  const double sum = a.cov_attitude(1, 1) + a.cov_attitude(2, 2) + 2 * a.cov_attitude(1, 2);
  EXPECT_LT(std::sqrt(sum), FromDegrees(0.5));
  const Eigen::Matrix3d R = AttitudeAt(c, c.seconds / 2);
  const double truth = std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
  EXPECT_LT(std::abs(WrapPi(a.azimuth + a.toolface - truth)), 4 * std::sqrt(sum));
}

TEST(VerticalFilter, AGapWidensIt) {
  const Crossing c = Pass(0.3, 0.5);
  std::vector<ImuSample> samples = Samples(c, Norway(), kRate, false);
  const double whole = Fly(c, Tactical(), samples).attitude().cov_attitude(1, 1);
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  samples.erase(middle, middle + 50);
  const VerticalFilter filter = Fly(c, Tactical(), samples);
  EXPECT_GT(filter.attitude().cov_attitude(1, 1), 4 * whole);
}

void CrossAll(int seeds, double wave_deg, bool has_gz) {
  // All bands together leave out one in a hundred.
  const double tail = 0.01 / 2 / (3 * 10);
  std::printf("rpm  closest  rms [deg]  sigma  limit  azimuth toolface inclination\n");
  for (const Cell& cell : kCells) {
    Crossing c = Pass(cell.rpm, cell.closest);
    c.wave = FromDegrees(wave_deg);
    const std::vector<ImuSample> perfect = Samples(c, Norway(), kRate, has_gz);
    Eigen::Vector3d normalised = Eigen::Vector3d::Zero();
    double squares = 0, variance = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      std::vector<ImuSample> samples = perfect;
      AddErrors(Tactical(), static_cast<std::uint64_t>(seed), samples);
      const AttitudeSample a = Fly(c, Tactical(), samples).attitude();
      const Eigen::Vector3d error = ErrorsAt(c, c.seconds, a);
      squares += error[1] * error[1];
      variance += a.cov_attitude(1, 1);
      normalised += error.cwiseAbs2().cwiseQuotient(a.cov_attitude.diagonal());
    }
    const double rms = ToDegrees(std::sqrt(squares / seeds));
    const Eigen::Vector3d mean = normalised / seeds;
    std::printf("%3.1f  %.2f  %.4f  %.4f  %.4f  %.3f %.3f %.3f\n", cell.rpm, cell.closest, rms,
                ToDegrees(std::sqrt(variance / seeds)), 1.15 * cell.best, mean[1], mean[2],
                mean[0]);
    const std::string where =
        std::to_string(cell.rpm) + " rpm " + std::to_string(cell.closest) + " deg";
    if (wave_deg == 0) {
      EXPECT_LE(rms, 1.15 * cell.best) << where;
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(normalised[i], ChiSquareQuantile(tail, seeds)) << where << ' ' << i;
      EXPECT_LT(normalised[i], ChiSquareQuantile(1 - tail, seeds)) << where << ' ' << i;
    }
  }
}

TEST(VerticalFilter, CrossesVerticalInAllCells) { CrossAll(WELLGYRO_CROSSING_SEEDS, 0, false); }
TEST(VerticalFilter, CrossesVerticalRollingToAndFro) {
  CrossAll(WELLGYRO_CROSSING_SEEDS, 25, false);
}
TEST(VerticalFilter, CrossesVerticalWithAThirdAxis) { CrossAll(WELLGYRO_CROSSING_SEEDS, 25, true); }

// Noise that looks like a turn about the axis parted a bias of the accelerometers from tilt, second
// after second the same way. Ended 3e-4 rad off.
TEST(VerticalFilter, ARestTeachesNoBiasOfTheAccelerometers) {
  Crossing rest;
  rest.closest = FromDegrees(1.5);
  rest.spin_up = 0;
  rest.seconds = 400;
  rest.speed = 0;
  Errors errors = Tactical();
  errors.priors.accel_bias_sigma = 2e-3;
  errors.priors.accel_noise = 2e-4;
  Errors drawn = errors;
  drawn.priors.accel_bias_sigma = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    std::vector<ImuSample> samples = Samples(rest, Norway(), 20, false);
    AddErrors(drawn, seed, samples);
    VerticalFilter filter({errors.gyro, errors.priors});
    for (const ImuSample& s : samples) {
      filter.Push(s, AlongAt(rest, 0), Norway());
      if (s.stamp.seq == 20) filter.SetAzimuth(AzimuthAt(rest, 1), 0);
      if (s.stamp.seq > 1200 && s.stamp.seq % 20 == 0) filter.Hold();
    }
    const double off = ErrorsAt(rest, rest.seconds, filter.attitude())[0];
    EXPECT_LT(std::abs(off), 4e-5) << seed;
  }
}

}  // namespace
}  // namespace wellgyro
