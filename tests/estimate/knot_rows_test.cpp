// The derivatives of every factor against differences of its cost.
#include "wellgyro/estimate/knot_rows.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

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
    rows.Add(knot, place, 0.01, x, a, b, block);
    double cost = 0;
    for (const RowSum& sum : block.sums()) cost += 0.5 * sum.cost;
    return cost;
  }
};

/// A knot whose residuals are some sigmas each: sigmas are large, so that angles of a hundredth of a
/// radian are, and the errors of the first order in a knot's own turn stay small beside them.
Case MakeCase(double inclination, bool still, bool axial) {
  Case c;
  c.setup.gyro = {.angle_random_walk = 2e-3, .rate_random_walk = 1e-3};
  c.setup.gyro.bias_instability = 1e-3;
  c.setup.gyro.bias_instability_correlation_time = 100;
  c.setup.gyro.rate_ramp = 1e-5;
  c.setup.errors = {.gyro_bias_sigma = 1e-3,          .mass_unbalance_sigma = 1e-4,
                    .quadrature_sigma = 1e-4,         .gyro_scale_sigma = 0.1,
                    .gyro_misalignment_sigma = 0.1,   .accel_bias_sigma = 0.05,
                    .accel_noise = 0.05,              .roll_offset_sigma = 0.1,
                    .time_skew_sigma = 0.1,           .latitude_sigma = 0.01};
  c.setup.swing = 0.3;
  c.setup.third_axis = axial;
  c.layout = LayoutOf(c.setup);
  Random random(static_cast<std::uint64_t>(100 * inclination) + still + 2 * axial);
  const auto pair = [&random](double s) { return Eigen::Vector2d(s * random.Normal(), s * random.Normal()); };
  Increment& inc = c.knot.increment;
  inc.seconds = 1;
  inc.roll_before = 0.15;
  inc.roll_after = 0.14;
  inc.turn_M = pair(2e-3);
  inc.turn_before_M = 0.5 * inc.turn_M;
  inc.turn_per_roll = pair(1e-4);
  inc.force_per_roll = pair(1e-2);
  inc.axial = 0.3;
  inc.has_axial = axial;
  for (int i = 0; i <= kTimeSkew; ++i) inc.turn_by_error.col(i) = pair(i < kGyroScaleX ? 1 : 0.01);
  for (int i = kAccelBiasX; i <= kAccelMisalignmentY; ++i) {
    inc.force_by_error.col(i) << pair(0.5), 0.3 * random.Normal();
  }
  c.place.site = SiteAt(1, 0);
  c.place.w_IL_L = {4e-5, 0, -6e-5};
  c.place.dw_by_latitude = {-6e-5, 0, -4e-5};
  c.place.force_L = {0.01, 0.02, -9.81};
  c.place.since_start = 30;
  c.place.depth = 100;
  c.border.setZero(c.layout.border);
  for (int i = 0; i < c.layout.border; ++i) c.border[i] = 0.1 * c.layout.sigma[i] * random.Normal();
  c.begin.R_LT = AttitudeMatrix(1, inclination, 0.7);
  c.begin.roll_rate = 0.29;
  c.begin.md = 10;
  c.begin.speed = 0.5;
  c.begin.walk = pair(1e-3);
  c.begin.markov = pair(1e-3);
  c.begin.swing = pair(0.01);
  c.end = c.begin;
  c.end.R_LT = c.begin.R_LT * RotationZ(still ? 0.0 : 0.29) * Exp(1e-3 * Vector3d(1, -2, 0.001));
  c.end.roll_rate = 0.3;
  c.end.md = 10.5;
  c.end.walk = pair(1e-3);
  const Vector3d f = c.begin.R_LT.transpose() * c.place.force_L;
  inc.force_M = RotationZ(0.15).transpose() * f + Vector3d(0.05, -0.03, 0.04);
  c.knot.still = still;
  c.knot.along = {.md = 10.501, .speed = 0.5, .sigma_md = 0.01, .known = true};
  return c;
}

void ExpectGradient(const Case& c, const std::string& what) {
  KnotRows rows(c.setup, c.layout);
  NormalBlock block;
  block.Clear(c.layout);
  rows.Add(c.knot, c.place, 0.01, c.border, c.begin, c.end, block);
  const int n = c.layout.node;
  for (int i = 0; i < 2 * n + c.layout.border; ++i) {
    // A step of a hundredth of what the factors resolve in this unknown.
    const double h = 1e-2 / std::sqrt(std::max(block.information()(i, i), 1e-12));
    double cost[2];
    for (const int side : {0, 1}) {
      const double step = side ? h : -h;
      Node a = c.begin, b = c.end;
      BorderVector x = c.border;
      if (i < n) Move(c.layout, NodeVector(NodeVector::Unit(n, i) * step), a);
      else if (i < 2 * n) Move(c.layout, NodeVector(NodeVector::Unit(n, i - n) * step), b);
      else x[i - 2 * n] += step;
      cost[side] = c.Cost(a, b, x);
    }
    const double slope = (cost[1] - cost[0]) / (2 * h);
    const double scale = std::sqrt(block.information()(i, i));
    EXPECT_NEAR(block.gradient()[i] / std::max(scale, 1e-6), slope / std::max(scale, 1e-6), 0.02)
        << what << " column " << i << " of " << n << " and " << c.layout.border;
  }
}

TEST(KnotRows, GradientIsThatOfTheCost) {
  for (const double inclination : {0.0, 0.02, 0.7, M_PI / 2, 1.9}) {
    ExpectGradient(MakeCase(inclination, false, false), "moving");
    ExpectGradient(MakeCase(inclination, true, false), "at rest");
    ExpectGradient(MakeCase(inclination, false, true), "third axis");
  }
}

}  // namespace
}  // namespace wellgyro
