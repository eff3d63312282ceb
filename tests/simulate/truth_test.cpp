#include "wellgyro/simulate/truth.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "wellgyro/math/rotation.h"
#include "wellgyro/simulate/ellipsoid.h"

#include "cases.h"

namespace wellgyro {
namespace {

using Vector3L = Eigen::Matrix<long double, 3, 1>;
using QuaternionL = Eigen::Quaternion<long double>;

QuaternionL Exp(const Vector3L& angle) {
  const long double half = angle.norm() / 2;
  const long double k = half < 1e-6L ? 0.5L - half * half / 12 : std::sin(half) / (2 * half);
  return {std::cos(half), k * angle.x(), k * angle.y(), k * angle.z()};
}

// L to the Earth, then to space, by geometry alone: no transport rate.
Eigen::Matrix<long double, 3, 3> R_IL(const TruthState& at, double earth_rate) {
  const long double turn = at.longitude + static_cast<long double>(earth_rate) * at.time;
  const long double tilt = -std::acos(-1.0L) / 2 - at.latitude;
  return (Eigen::AngleAxis<long double>(turn, Vector3L::UnitZ()) *
          Eigen::AngleAxis<long double>(tilt, Vector3L::UnitY()))
      .toRotationMatrix();
}

double AngleBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const Eigen::Matrix3d d = a.transpose() * b;
  return Eigen::Vector3d(d(2, 1) - d(1, 2), d(0, 2) - d(2, 0), d(1, 0) - d(0, 1)).norm() / 2;
}

// Magnus, fourth order: exp of the integral of the rate and its first commutator, at two Gauss
// points. What is left of it over an hour, 1e-11 rad at 5 ms, falls to 1e-12 at 2.5 ms: it comes
// from steps across the joints of the run and of the spline, not from the truth.
QuaternionL Step(const Truth& truth, double begin, double h, const QuaternionL& q) {
  const double apart = h * std::sqrt(3.0) / 6, middle = begin + h / 2;
  const Vector3L w1 = truth.SensorsAt(middle - apart).w_IT_T.cast<long double>();
  const Vector3L w2 = truth.SensorsAt(middle + apart).w_IT_T.cast<long double>();
  const long double step = h;
  return q * Exp(step / 2 * (w1 + w2) + std::sqrt(3.0L) / 12 * step * step * w1.cross(w2));
}

void ExpectRatesLeadToAttitudes(const Simulation& simulation, double tolerance) {
  const Truth truth(simulation);
  const double h = 0.005, rate = simulation.earth.rate;
  const TruthState begin = truth.At(0);
  QuaternionL q(R_IL(begin, rate) * begin.R_LT.cast<long double>());
  const auto steps = static_cast<int>(truth.seconds() / h);
  double worst = 0;
  for (int i = 0; i < steps; ++i) {
    q = Step(truth, i * h, h, q);
    if (i % 2000 != 1999) continue;
    const TruthState at = truth.At((i + 1) * h);
    const Eigen::Matrix<long double, 3, 3> R_LT =
        R_IL(at, rate).transpose() * q.normalized().toRotationMatrix();
    worst = std::max(worst, AngleBetween(R_LT.cast<double>(), at.R_LT));
  }
  EXPECT_LT(worst, tolerance);
  EXPECT_GT(truth.seconds(), 3600);
}

TEST(Truth, RatesIntegratedInSpaceGiveTheAttitude) {
  ExpectRatesLeadToAttitudes(WeavingRun(), 2e-11);
}

TEST(Truth, RatesGiveTheAttitudeWithRollFromTheHighSide) {
  Simulation s = WeavingRun();
  s.run.roll_reference = RollReference::kHighSide;
  ExpectRatesLeadToAttitudes(s, 2e-11);
}

TEST(Truth, RatesGiveTheAttitudeThroughVertical) {
  Simulation s = WeavingRun();
  s.well = StationWell();
  s.run.start_md = 0;
  const RunRoll roll{.rate = 0.2, .amplitude = 0.3, .period = 15};
  s.run.steps = {RunMove{.to_md = 1400, .speed = 0.6, .roll = roll},
                 RunMove{.to_md = 20, .speed = 1, .roll = roll}};
  ExpectRatesLeadToAttitudes(s, 2e-11);
}

TEST(Truth, RatesGiveTheAttitudeOfAToolThatRestsWhereItHasSwungTo) {
  Simulation s = WeavingRun();
  const RunRoll roll{.amplitude = 0.4, .period = 90, .phase = 0.7, .rests_there = true};
  s.run.steps = {RunMove{.to_md = 1300, .speed = 0.9, .ramp = 8, .roll = roll},
                 RunStop{.seconds = 30},
                 RunMove{.to_md = 2500, .speed = 0.7, .ramp = 12, .roll = roll},
                 RunMove{.to_md = 1700, .speed = 0.9, .ramp = 12, .roll = roll}};
  ExpectRatesLeadToAttitudes(s, 2e-11);
}

TEST(Truth, AttitudeIsOfItsAngles) {
  const Truth truth(WeavingRun());
  for (double t = 1; t < truth.seconds(); t += 13.3) {
    const TruthState at = truth.At(t);
    // A roll of 600 rad is known to 1.1e-13.
    EXPECT_LT((at.R_LT - AttitudeMatrix(at.azimuth, at.inclination, at.toolface)).norm(), 5e-13);
    EXPECT_EQ(at.toolface, WrapTwoPi(at.toolface));
  }
}

TEST(Truth, CommandedToolfaceIsTheToolface) {
  Simulation s = WeavingRun();
  s.run.roll_reference = RollReference::kHighSide;
  const Truth truth(s);
  for (double t = 1; t < truth.seconds(); t += 13.3) {
    EXPECT_NEAR(WrapPi(truth.At(t).toolface - truth.plan().At(t).roll), 0, 1e-13);
  }
}

TEST(Truth, NoHighSideInAVerticalHole) {
  Simulation s = WeavingRun();
  s.well = StationWell();
  s.run.steps = {RunMove{.to_md = 700}};
  EXPECT_NO_THROW(Truth{s});
  s.run.roll_reference = RollReference::kHighSide;
  EXPECT_THROW(Truth{s}, std::invalid_argument);
}

// Newton in space: f = d2r/dt2 less gravitation, and gravitation is gravity less what the turning
// Earth takes from it. Positions in Earth-centred axes, second differences over 1 s.
TEST(Truth, SpecificForceIsNewtons) {
  const Simulation s = WeavingRun();
  const Truth truth(s);
  const long double rate = s.earth.rate;
  const auto position = [&](double t) -> Vector3L {
    const TruthState at = truth.At(t);
    const long double f = 1 / 298.257223563L, e2 = f * (2 - f), latitude = at.latitude;
    const long double sl = std::sin(latitude), cl = std::cos(latitude);
    const long double n = 6378137.0L / std::sqrt(1 - e2 * sl * sl);
    const long double turn = at.longitude + rate * t, h = at.height;
    return {(n + h) * cl * std::cos(turn), (n + h) * cl * std::sin(turn), (n * (1 - e2) + h) * sl};
  };
  const double h = 0.5;
  const Vector3L omega(0, 0, rate);
  double coriolis = 0;
  for (double t = 20; t < truth.seconds() - 20; t += 19.37) {
    const Vector3L r = position(t);
    const Vector3L acceleration = (16 * (position(t + h) + position(t - h)) -
                                   (position(t + 2 * h) + position(t - 2 * h)) - 30 * r) /
                                  (12 * h * h);
    const TruthState at = truth.At(t);
    const double g = EllipsoidAt(std::sin(at.latitude), at.height).gravity;
    const Eigen::Matrix3d R_IT = R_IL(at, s.earth.rate).cast<double>() * at.R_LT;
    const Eigen::Vector3d down = R_IL(at, s.earth.rate).cast<double>().col(2);
    const Eigen::Vector3d f =
        (acceleration - omega.cross(omega.cross(r))).cast<double>() - g * down;
    // Of the difference: h^4 / 90 times the sixth derivative of depth on a ramp of 8 s.
    const bool ramp = truth.plan().At(t - 1).acceleration != truth.plan().At(t + 1).acceleration;
    EXPECT_LT((truth.SensorsAt(t).f_T - R_IT.transpose() * f).norm(), ramp ? 2e-5 : 5e-8) << t;
    coriolis = std::max(coriolis, 2 * s.earth.rate * std::abs(at.speed));
  }
  EXPECT_GT(coriolis, 1e-4) << "the smallest term that must be seen";
}

TEST(Truth, AnAnomalyIsAddedToGravityAndGrowsWithDepth) {
  Simulation s = AtRest(0.7, 2.1, 4.0, 60);
  s.well.begin_p_WT_W.z() = 500;
  const Truth normal(s);
  s.earth.gravity_anomaly = -3e-4;
  s.earth.gravity_gradient_anomaly = 2e-7;
  const Truth truth(s);
  const double more = -3e-4 + 2e-7 * truth.At(30).p_WT_W.z();
  EXPECT_GT(truth.At(30).p_WT_W.z(), 400);
  EXPECT_NEAR(truth.SensorsAt(30).f_T.norm() - normal.SensorsAt(30).f_T.norm(), more, 1e-14);
}

TEST(Truth, AtRestItFeelsGravityAndTheEarth) {
  const double inclination = 0.7, azimuth = 2.1, toolface = 4.0;
  const Truth truth(AtRest(inclination, azimuth, toolface, 60));
  const SensorTruth at = truth.SensorsAt(30);
  const double g = EllipsoidAt(std::sin(truth.At(30).latitude), truth.At(30).height).gravity;
  const double si = std::sin(inclination), ci = std::cos(inclination);
  EXPECT_LT(
      (at.f_T - g * Eigen::Vector3d(si * std::cos(toolface), -si * std::sin(toolface), -ci)).norm(),
      1e-14);
  // Across the axis, by the meaning agreed for w_h + i w_r = (w_x + i w_y) e^{iT}.
  const double latitude = truth.At(30).latitude, rate = 7.292115e-5;
  const double h = rate * (std::cos(latitude) * std::cos(azimuth) * ci + std::sin(latitude) * si);
  const double r = -rate * std::cos(latitude) * std::sin(azimuth);
  const double c = std::cos(toolface), s = std::sin(toolface);
  EXPECT_NEAR(at.w_IT_T.x() * c - at.w_IT_T.y() * s, h, 1e-18);
  EXPECT_NEAR(at.w_IT_T.x() * s + at.w_IT_T.y() * c, r, 1e-18);
}

// A whole second at once, as hundredths, and by 2000 midpoints.
TEST(Truth, MeansDoNotDependOnHowTheyAreTaken) {
  const Truth truth(WeavingRun());
  const double ramp_end = truth.plan().NextBreak(130.5);
  for (const double begin : {59.3, 64.0, 129.4, 400.0, 1111.1, ramp_end - 0.37}) {
    const SensorTruth whole = truth.MeanOver(begin, begin + 1);
    SensorTruth parts, fine;
    for (int i = 0; i < 100; ++i) {
      const SensorTruth part = truth.MeanOver(begin + i * 0.01, begin + (i + 1) * 0.01);
      parts.w_IT_T += part.w_IT_T / 100;
      parts.f_T += part.f_T / 100;
    }
    for (int i = 0; i < 2000; ++i) {
      const SensorTruth at = truth.SensorsAt(begin + (i + 0.5) / 2000);
      fine.w_IT_T += at.w_IT_T / 2000;
      fine.f_T += at.f_T / 2000;
    }
    EXPECT_LT((whole.w_IT_T - parts.w_IT_T).norm(), 1e-14) << begin;
    EXPECT_LT((whole.f_T - parts.f_T).norm(), 1e-12) << begin;
    EXPECT_LT((whole.w_IT_T - fine.w_IT_T).norm(), 3e-8) << begin;
    EXPECT_LT((whole.f_T - fine.f_T).norm(), 1e-6) << begin;
  }
}

// The sum of an hour's sample angles against Simpson's rule on a grid of its own, in long double.
TEST(Truth, AnHoursAnglesAreRightToTenToTheMinusTen) {
  const Truth truth(WeavingRun());
  Vector3L sum = Vector3L::Zero(), simpson = Vector3L::Zero();
  for (int i = 0; i < 36000; ++i) {
    sum += 0.1L * truth.MeanOver(i * 0.1, (i + 1) * 0.1).w_IT_T.cast<long double>();
  }
  // Between breaks, where everything is smooth; 5 ms against 20 s of roll: (h w)^4 / 2880.
  for (double at = 0; at < 3600;) {
    const double stop = std::min(truth.plan().NextBreak(at), 3600.0);
    const int pieces = 2 * static_cast<int>(std::ceil((stop - at) / 0.01));
    const double h = (stop - at) / pieces;
    for (int i = 0; i <= pieces; ++i) {
      const long double weight = i == 0 || i == pieces ? 1 : i % 2 == 1 ? 4 : 2;
      simpson += weight * h / 3 * truth.SensorsAt(at + i * h).w_IT_T.cast<long double>();
    }
    at = stop;
  }
  EXPECT_LT((sum - simpson).norm(), 1e-10L);
  EXPECT_GT(simpson.norm(), 100);
}

// The spline of a well by stations has a jump in its third derivative at every knot; neither that
// nor the length of the samples shows.
TEST(Truth, AnHoursAnglesDoNotDependOnTheSampleRate) {
  Simulation s = WeavingRun();
  s.well = StationWell();
  s.run.start_md = 10;
  const RunRoll roll{.rate = 0.3, .amplitude = 0.2, .period = 9};
  s.run.steps = {RunMove{.to_md = 1390, .speed = 0.75, .roll = roll},
                 RunMove{.to_md = 50, .speed = 0.75, .roll = roll}};
  const Truth truth(s);
  Vector3L sum = Vector3L::Zero(), fine = Vector3L::Zero();
  double worst = 0;
  for (int i = 0; i < 3600; ++i) {
    sum += truth.MeanOver(i, i + 1).w_IT_T.cast<long double>();
    for (int k = 0; k < 100; ++k) {
      fine += 0.01L * truth.MeanOver(i + k * 0.01, i + (k + 1) * 0.01).w_IT_T.cast<long double>();
    }
    worst = std::max(worst, static_cast<double>((sum - fine).norm()));
  }
  EXPECT_LT(worst, 1e-10);
}

TEST(Truth, LeverArmIsTheMotionOfThatPoint) {
  // Off-axis f less on-axis f is the second derivative in space of R_IT l.
  const Simulation s = WeavingRun();
  const Truth truth(s);
  const Eigen::Vector3d arm(0.02, -0.01, 0.3);
  const double h = 0.01;
  const auto point = [&](double t) -> Vector3L {
    const TruthState at = truth.At(t);
    return R_IL(at, s.earth.rate) * (at.R_LT * arm).cast<long double>();
  };
  for (const double t : {64.0, 134.0, 300.0, 1500.0}) {
    const Vector3L acceleration = (16 * (point(t + h) + point(t - h)) -
                                   (point(t + 2 * h) + point(t - 2 * h)) - 30 * point(t)) /
                                  (12 * h * h);
    const Eigen::Matrix3d R_IT = R_IL(truth.At(t), s.earth.rate).cast<double>() * truth.At(t).R_LT;
    const Eigen::Vector3d expected = R_IT.transpose() * acceleration.cast<double>();
    const Eigen::Vector3d mean =
        truth.MeanOver(t - 1e-4, t + 1e-4, arm).f_T - truth.MeanOver(t - 1e-4, t + 1e-4).f_T;
    EXPECT_LT((mean - expected).norm(), 1e-8) << t;
    EXPECT_GT(expected.norm(), 1e-4);
  }
}

TEST(Truth, FieldTurnsWithTheTool) {
  Simulation s = AtRest(0.5, 1.2, 0.3, 10);
  s.earth.field_L = {15e-6, 0.2e-6, 48e-6};
  const Truth truth(s);
  const Eigen::Vector3d b = truth.SensorsAt(5).b_T;
  EXPECT_LT((AttitudeMatrix(1.2, 0.5, 0.3) * b - s.earth.field_L).norm(), 1e-19);
}

}  // namespace
}  // namespace wellgyro
