// The derivatives of every factor against differences of its cost.
#include "wellgyro/estimate/knot_rows.h"

#include <cmath>
#include <cstdio>
#include <string>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;

struct Case {
  EstimateSetup setup;
  Layout layout;
  RunKnot knot;
  KnotPlace place;
  BorderVector border;
  Node begin, end;

  double Cost(const Node& a, const Node& b, const BorderVector& x) const {
    KnotRows rows(setup, layout);
    NormalBlock block;
    block.Clear(layout);
    KnotPlace turned = place;
    const double heading = Log(a.R_LT * begin.R_LT.transpose()).z();
    turned.acceleration_L = Exp(Vector3d(0, 0, heading)) * place.acceleration_L;
    rows.Add(knot, turned, {.sigma = 0.01}, x, a, b, block);
    double cost = 0;
    for (const RowSum& sum : block.sums()) cost += 0.5 * sum.cost;
    return cost;
  }
};

/// A good tool with every error that there is.
EstimateSetup EveryError(bool axial) {
  EstimateSetup setup;
  setup.gyro = {.angle_random_walk = 3e-6, .rate_random_walk = 1e-6};
  setup.gyro.bias_instability = 1e-6;
  setup.gyro.bias_instability_correlation_time = 100;
  setup.gyro.rate_ramp = 1e-8;
  setup.errors = {.gyro_bias_sigma = 1e-6,
                  .mass_unbalance_sigma = 1e-7,
                  .quadrature_sigma = 1e-7,
                  .gyro_scale_sigma = 1e-3,
                  .gyro_misalignment_sigma = 1e-3,
                  .accel_bias_sigma = 1e-3,
                  .accel_scale_sigma = 1e-3,
                  .accel_misalignment_sigma = 1e-3,
                  .accel_noise = 1e-3,
                  .roll_offset_sigma = 1e-3,
                  .time_skew_sigma = 1e-3,
                  .latitude_sigma = 1e-3};
  // A second order as large as the biases.
  setup.cov_errors = ErrorCovariance{.reference = 50, .span = 10};
  setup.cov_errors->constant.diagonal().tail<kSecondOrderSources>().setConstant(1e-10);
  setup.cov_errors->change.diagonal().head<kAccelSecondOrder>().setConstant(1e-6);
  setup.cov_errors->change.diagonal().head<4>().setConstant(1e-12);
  setup.cov_errors->constant.diagonal().segment<3>(kGyroMisalignmentZX).setConstant(1e-6);
  setup.cov_errors->constant.diagonal().segment<2>(kUnbalanceDifference).setConstant(1e-14);
  if (!axial) setup.swing = 0.3;
  setup.third_axis = axial;
  return setup;
}

Eigen::Vector2d Pair(double sigma, Random& random) {
  return Eigen::Vector2d{sigma * random.Normal(), sigma * random.Normal()};
}

/// A second of a tool that rolls, or turns with the hole by `still_M` in it.
Increment AnyIncrement(double roll, const Eigen::Vector2d* still_M, bool axial, Random& random) {
  Increment inc;
  inc.seconds = 1;
  inc.roll_before = 0.5 * roll;
  inc.roll_after = 0.5 * roll;
  inc.turn_M = still_M != nullptr ? *still_M : Pair(1e-3, random);
  inc.turn_before_M = 0.5 * inc.turn_M;
  if (still_M == nullptr) inc.turn_per_roll = Pair(1e-4, random);
  inc.force_per_roll = Pair(1e-2, random);
  inc.has_axial = axial;
  if (!axial) {
    inc.wobble_followed = {10, 8};  // more than all of it, so that it counts beside the rest
    for (int i = 0; i < 4; ++i) inc.turn_by_harmonic.col(i) = Pair(0.01, random);
  }
  for (int i = 0; i <= kTimeSkew; ++i) {
    inc.turn_by_error.col(i) = Pair(i < kGyroScaleX ? 1 : 0.01, random);
  }
  for (int i = kAccelBiasX; i <= kAccelMisalignmentZY; ++i) {
    const Eigen::Vector2d across = Pair(0.5, random);
    inc.ForceBy(i) << across, 0.3 * random.Normal();
  }
  return inc;
}

/// The knot's end, near what it predicts: the tie about the axis is a millionth of a radian.
void AddEnd(bool still, Random& random, Case& c) {
  const Increment& inc = c.knot.increment;
  c.end = c.begin;
  const double swing =
      std::sin(0.3) / 0.3 * c.begin.swing.x() + (1 - std::cos(0.3)) / 0.3 * c.begin.swing.y();
  const Eigen::Vector2d turn = inc.turn_M + swing * inc.turn_per_roll;
  c.end.R_LT = Exp(-c.place.w_IL_L) * c.begin.R_LT * RotationZ(inc.roll_before + 0.5 * swing) *
               Exp(Vector3d(turn.x(), turn.y(), 0)) * RotationZ(inc.roll_after + 0.5 * swing) *
               Exp((still ? 3e-7 : 3e-6) * Vector3d(1, -0.7, 0) + 1e-6 * Vector3d::UnitZ());
  c.end.roll_rate = c.begin.roll_rate + 0.01;
  c.end.md = c.begin.md + c.begin.speed;
  c.end.walk_T.head<2>() = Pair(1e-6, random);
  if (inc.has_axial) c.end.walk_T.z() = 1e-6 * random.Normal();
}

/// A knot of a good tool whose residuals are some sigmas each, so that the losses are on, and that
/// has warmed by half of its span.
Case MakeCase(double inclination, bool still, bool axial) {
  Case c;
  c.setup = EveryError(axial);
  c.layout = LayoutOf(c.setup);
  Random random(static_cast<std::uint64_t>(100 * inclination) + still + 2 * axial);
  const Eigen::Matrix3d R_LT = AttitudeMatrix(1, inclination, 0.7);
  const Vector3d w_IL_L(4e-5, 0, -6e-5), w_T = R_LT.transpose() * w_IL_L;
  const double roll = still ? w_T.z() : 0.29;
  const Eigen::Vector2d still_M = w_T.head<2>();
  c.knot.temperature = 55;
  c.knot.increment = AnyIncrement(roll, still ? &still_M : nullptr, axial, random);
  c.place.site = SiteAt(1, 0);
  c.place.w_IL_L = w_IL_L;
  c.place.dw_by_latitude_L = {-6e-5, 0, -4e-5};
  c.place.acceleration_L = {0.01, 0.02, 0.001};
  c.place.since_start = 30;
  c.place.depth = 100;
  c.border.setZero(c.layout.border);
  c.begin.R_LT = R_LT;
  c.begin.roll_rate = roll;
  c.begin.md = 10;
  c.begin.speed = still ? 0 : 0.5;
  if (!still && !axial) c.begin.swing = Pair(2e-3, random);
  AddEnd(still, random, c);
  const Vector3d f = c.begin.R_LT.transpose() *
                     (c.place.acceleration_L - c.place.site.gravity * Vector3d::UnitZ());
  Increment& inc = c.knot.increment;
  inc.force_M = RotationZ(inc.roll_before).transpose() * f + Vector3d(1e-3, -0.6e-3, 0.8e-3);
  c.knot.still = still;
  c.knot.along = {.md = c.end.md + 0.001, .speed = c.begin.speed, .sigma_md = 0.01, .known = true};
  return c;
}

/// Scales of gyros: their columns leave out the readings' noise, which the cost has; see
/// EstimatedRun.NoiseDrawsNoScale.
bool IsGyroScale(const Layout& layout, int border_column) {
  for (const std::size_t source : {kGyroScaleX, kGyroScaleY, kGyroScaleZ}) {
    if (border_column < 0) continue;
    if (layout.source[source] == border_column || layout.change[source] == border_column)
      return true;
  }
  return false;
}

void ExpectGradient(const Case& c, const std::string& what) {
  KnotRows rows(c.setup, c.layout);
  NormalBlock block;
  block.Clear(c.layout);
  rows.Add(c.knot, c.place, {.sigma = 0.01}, c.border, c.begin, c.end, block);
  const int n = c.layout.node;
  for (int i = 0; i < 2 * n + c.layout.border; ++i) {
    if (IsGyroScale(c.layout, i - 2 * n)) continue;
    // A step of a hundredth of what the factors resolve in this unknown.
    const double h = 1e-2 / std::sqrt(std::max(block.information()(i, i), 1e-12));
    double cost[2];
    for (const int side : {0, 1}) {
      const double step = side ? h : -h;
      Node a = c.begin, b = c.end;
      BorderVector x = c.border;
      if (i < n)
        Move(c.layout, NodeVector(NodeVector::Unit(n, i) * step), a);
      else if (i < 2 * n)
        Move(c.layout, NodeVector(NodeVector::Unit(n, i - n) * step), b);
      else
        x[i - 2 * n] += step;
      cost[side] = c.Cost(a, b, x);
    }
    const double slope = (cost[1] - cost[0]) / (2 * h);
    const double scale = std::sqrt(block.information()(i, i));
    EXPECT_NEAR(block.gradient()[i] / std::max(scale, 1e-6), slope / std::max(scale, 1e-6), 0.05)
        << what << " column " << i << " of " << n << " and " << c.layout.border;
  }
}

/// Gives the case a tool whose errors go round with it; these errors.
ErrorVector TakeErrors(Case& c) {
  c.setup.gyro.angle_random_walk = 3e-6;
  c.setup.errors = {.gyro_bias_sigma = 1e-6,
                    .gyro_misalignment_sigma = 3e-4,
                    .accel_bias_sigma = 5e-3,
                    .accel_misalignment_sigma = 5e-4,
                    .accel_noise = 2.5e-4};
  c.layout = LayoutOf(c.setup);
  c.border.setZero(c.layout.border);
  ErrorVector error = ErrorVector::Zero();
  const auto is = [&](ErrorSource source, double value) {
    error[source] = c.border[c.layout.source[source]] = value;
  };
  is(kGyroBiasX, 2e-6);
  is(kGyroBiasY, -1e-6);
  is(kMisalignmentX, 3e-4);
  is(kMisalignmentY, -2e-4);
  is(kAccelBiasX, 5e-3);
  is(kAccelBiasY, 3e-3);
  is(kAccelMisalignmentX, -4e-4);
  is(kAccelMisalignmentY, 6e-4);
  return error;
}

/// Of a second in which the tool rolls at `rate` [rad/s] and gravity does not show it, psi = 0,
/// with errors that go round with the tool.
Case RollingUnseen(double rate) {
  Case c;
  const ErrorVector error = TakeErrors(c);
  c.place.site = SiteAt(1, 0);
  const double gravity = c.place.site.gravity;
  const Vector3d bend(7e-4, -3e-4, 0);
  c.begin.R_LT = AttitudeMatrix(1, FromDegrees(0.5), 0.7);
  c.begin.roll_rate = rate;
  const auto attitude = [&](double t) -> Eigen::Matrix3d {
    return c.begin.R_LT * Exp(t * bend) * RotationZ(rate * t);
  };
  Increment& inc = c.knot.increment;
  inc.seconds = 1;
  inc.level = true;
  inc.turn_by_error.col(kGyroBiasX) = Eigen::Vector2d::UnitX();
  inc.turn_by_error.col(kGyroBiasY) = Eigen::Vector2d::UnitY();
  inc.ForceBy(kAccelBiasX) = Vector3d::UnitX();
  inc.ForceBy(kAccelBiasY) = Vector3d::UnitY();
  constexpr int kParts = 2000;
  const auto part = [&](int i) { return (i + 0.5) / kParts; };
  const auto turn = [&](int i) -> Eigen::Vector2d {
    const Eigen::Vector2d skew(error[kMisalignmentX], error[kMisalignmentY]);
    return ((RotationZ(-rate * part(i)) * bend).head<2>() + rate * skew +
            error.segment<2>(kGyroBiasX)) /
           kParts;
  };
  for (int i = 0; i < kParts / 2; ++i) inc.turn_before_M += turn(i);
  for (int i = 0; i < kParts; ++i) {
    const double late = part(i) - 0.5;
    Vector3d f = -gravity * attitude(part(i)).row(2).transpose();
    f.head<2>() += error.segment<2>(kAccelBiasX) + f.z() * error.segment<2>(kAccelMisalignmentX);
    f /= kParts;
    const Eigen::Vector2d behind = inc.turn_M - inc.turn_before_M;  // the middle
    inc.force_M += Exp(Vector3d(behind.x(), behind.y(), 0)) * f;
    inc.force_per_roll += late * Eigen::Vector2d(-f.y(), f.x());
    inc.turn_per_roll += late * Eigen::Vector2d(-turn(i).y(), turn(i).x());
    inc.turn_M += turn(i);
  }
  inc.ForceBy(kAccelMisalignmentX) = inc.force_M.z() * Vector3d::UnitX();
  inc.ForceBy(kAccelMisalignmentY) = inc.force_M.z() * Vector3d::UnitY();
  c.end = c.begin;
  c.end.R_LT = attitude(1);
  return c;
}

TEST(KnotRows, GradientIsThatOfTheCost) {
  for (const double inclination : {0.0, 0.02, 0.7, M_PI / 2, 1.9}) {
    ExpectGradient(MakeCase(inclination, false, false), "moving");
    ExpectGradient(MakeCase(inclination, true, false), "at rest");
    ExpectGradient(MakeCase(inclination, false, true), "third axis");
    // Without forces the accelerometers' errors count by the phase that turns the rates alone.
    Case turned = MakeCase(inclination, false, false);
    turned.knot.increment.level = false;
    turned.knot.increment.turn_by_harmonic *= 0.01;
    ExpectGradient(turned, "phase");
  }
  for (const double rate : {-0.3, 0.63, 1.05}) ExpectGradient(RollingUnseen(rate), "hidden");
}

// Only the Earth's rate tells a heading: were it nought, a turn of both nodes about the vertical
// would change no residual, however large. In thousands of knots the least share of it adds up.
TEST(KnotRows, WithoutTheEarthsRateNoKnotTellsAHeading) {
  for (const double inclination : {0.0, 0.02, 0.7, M_PI / 2, 1.9}) {
    for (const bool still : {false, true}) {
      Case c = MakeCase(inclination, still, false);
      c.place.w_IL_L.setZero();
      c.place.dw_by_latitude_L.setZero();
      KnotRows rows(c.setup, c.layout);
      NormalBlock block;
      block.Clear(c.layout);
      rows.Add(c.knot, c.place, {.sigma = 0.01}, c.border, c.begin, c.end, block);
      NormalBlock::Vector turn = NormalBlock::Vector::Zero(block.gradient().size());
      turn.segment<3>(c.layout.phi) = c.begin.R_LT.row(2).transpose();
      turn.segment<3>(block.next() + c.layout.phi) = c.end.R_LT.row(2).transpose();
      const Eigen::MatrixXd all = block.information().selfadjointView<Eigen::Lower>();
      // With first derivatives good to the residuals' size only, it would be a sum of their
      // squares.
      EXPECT_LT(turn.dot(all * turn), 1e-2) << inclination << " " << still;
      EXPECT_GT(
          block.sums()[static_cast<std::size_t>(still ? RowKind::kStill : RowKind::kTurn)].squares,
          1);
    }
  }
}

/// Of a second in which the roll of a tool swings by 30 deg in 15 s, here where it turns back, and
/// gravity does not show it: the samples are summed as they come, psi = 0.
Case SwingingUnseen() {
  Case c;
  c.setup.gyro.angle_random_walk = 3e-6;
  c.setup.errors.accel_noise = 2.5e-4;
  c.setup.swing = kTwoPi / 15;
  c.layout = LayoutOf(c.setup);
  c.border.setZero(c.layout.border);
  c.place.site = SiteAt(1, 0);
  c.place.w_IL_L.setZero();
  c.place.acceleration_L.setZero();
  const double gravity = c.place.site.gravity, w = *c.setup.swing, amplitude = FromDegrees(30);
  const Vector3d bend(7e-4, -3e-4, 0);
  c.begin.R_LT = AttitudeMatrix(1, FromDegrees(0.5), 0.7);
  // A quarter of a period on from the greatest rate it turns back.
  const double begin = 0.25 * kTwoPi - 0.5 * w;
  const auto roll = [&](double t) {
    return amplitude * (std::sin(begin + w * t) - std::sin(begin));
  };
  const auto swing = [&](double t) -> Eigen::Vector2d {
    return amplitude * w * Eigen::Vector2d(std::cos(begin + w * t), -std::sin(begin + w * t));
  };
  const auto attitude = [&](double t) -> Eigen::Matrix3d {
    return c.begin.R_LT * Exp(t * bend) * RotationZ(roll(t));
  };
  Increment& inc = c.knot.increment;
  inc.seconds = 1;
  inc.level = true;
  constexpr int kParts = 2000;
  const auto part = [&](int i) { return (i + 0.5) / kParts; };
  const auto turn = [&](int i) -> Eigen::Vector2d {
    return (RotationZ(-roll(part(i))) * bend).head<2>() / kParts;
  };
  for (int i = 0; i < kParts / 2; ++i) inc.turn_before_M += turn(i);
  for (int i = 0; i < kParts; ++i) {
    const double late = part(i) - 0.5;
    const Vector3d f = -gravity / kParts * attitude(part(i)).row(2).transpose();
    const Eigen::Vector2d behind = inc.turn_M - inc.turn_before_M;  // the middle
    inc.force_M += Exp(Vector3d(behind.x(), behind.y(), 0)) * f;
    inc.force_per_roll += late * Eigen::Vector2d(-f.y(), f.x());
    inc.turn_per_roll += late * Eigen::Vector2d(-turn(i).y(), turn(i).x());
    inc.turn_M += turn(i);
    c.place.roll_bow += (roll(part(i)) - part(i) * roll(1)) / kParts;
  }
  c.begin.swing = swing(0);
  c.end = c.begin;
  c.end.swing = swing(1);
  c.end.R_LT = attitude(1);
  return c;
}

// An even turn of the tool by what it turned by in all would leave 2.6 sigmas of force in each such
// knot, and with biases that decide where gravity is seen, a fifth of a bias.
TEST(KnotRows, ASwingBowsTheRollOfAKnot) {
  const Case c = SwingingUnseen();
  KnotRows rows(c.setup, c.layout);
  NormalBlock block;
  block.Clear(c.layout);
  rows.Add(c.knot, c.place, {.sigma = 0.01}, c.border, c.begin, c.end, block);
  for (const RowKind kind : {RowKind::kTurn, RowKind::kForce}) {
    EXPECT_LT(block.sums()[static_cast<std::size_t>(kind)].squares, 0.01) << static_cast<int>(kind);
  }
}

// Skewed gyros read 26 deg/h of a roll of 10 rpm that nothing shows, mostly not where the tool
// turned in the mean of a knot. To the fourth order of the turn, a radian.
TEST(KnotRows, ErrorsGoRoundWithAToolWhoseRollIsHidden) {
  for (const double rpm : {1.0, -3.0, 6.0, 10.0}) {
    const Case c = RollingUnseen(kTwoPi / 60 * rpm);
    KnotRows rows(c.setup, c.layout);
    NormalBlock block;
    block.Clear(c.layout);
    rows.Add(c.knot, c.place, {.sigma = 0.01}, c.border, c.begin, c.end, block);
    const double turn = block.sums()[static_cast<std::size_t>(RowKind::kTurn)].squares;
    const double force = block.sums()[static_cast<std::size_t>(RowKind::kForce)].squares;
    std::printf("%g rpm: squares of the turn %.2g, of the force %.2g\n", rpm, turn, force);
    EXPECT_LT(turn, 0.01) << rpm;
    EXPECT_LT(force, 0.05) << rpm;
  }
}

}  // namespace
}  // namespace wellgyro
