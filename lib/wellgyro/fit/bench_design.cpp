#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Dense>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/bench_design_internal.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

// Parameters: b and U of two channels, M, Q, N of two; then, where temperatures vary, b tau and
// b tau^2 of two, M tau, Q tau.
constexpr int kPlain = 12, kMost = 18;
using Pair = Eigen::Matrix<double, 2, kMost>;

int SizeOf(const BenchPlanSetup& setup) {
  if (setup.temperatures == 1) return kPlain;
  return setup.temperatures == 2 ? kPlain + 4 : kMost;
}

// By what the two channels' readings change with the parameters.
Pair RowsOf(const BenchSetting& at, BenchAxes axes, double latitude) {
  const Eigen::Matrix3d R = BenchFromLevel(axes, at.inclination, at.azimuth, at.toolface);
  const Eigen::Vector3d w =
      R * kBenchEarthDegPerHour * Eigen::Vector3d(std::cos(latitude), 0, -std::sin(latitude));
  const Eigen::Vector3d f = -R.col(2);
  Pair rows = Pair::Zero();
  for (int c = 0; c < 2; ++c) {
    rows(c, 4 * c) = 1;
    rows.block<1, 3>(c, 4 * c + 1) = w.transpose();
    rows(c, 10 + c) = f[c] * f.z();
  }
  rows(0, 8) = f.x();
  rows(0, 9) = f.y();
  rows(1, 8) = f.y();
  rows(1, 9) = -f.x();
  rows(0, 12) = rows(1, 13) = at.tau;
  rows.block<2, 2>(0, 14) = at.tau * rows.block<2, 2>(0, 8);
  rows(0, 16) = rows(1, 17) = at.tau * at.tau;
  return rows;
}

// Evenly from one to the other; the ends of a whole circle once.
std::vector<double> Between(double from, double to, int n, bool circle = false) {
  std::vector<double> values;
  const double step = (to - from) / (circle ? n : n - 1);
  for (int k = 0; k < n; ++k) values.push_back(from + k * step);
  return values;
}

// Of a hole that is vertical all along some parameters move no azimuth, but no fit of the bench
// goes without them. sin 0.5 deg = 0.9 %: what goes with sin I weighs 8e-5 of its variance in a
// horizontal hole, so that it must be determined but does not steer the plan: with 0.25
// deg one setting more is needed near vertical, with 1 deg as many.
constexpr double kLeastInclination = 0.5 * units::kDeg;

// Of a named hole, stations a degree apart; else the ranges'.
std::vector<BenchPlanSetup::Direction> DirectionsOf(const BenchPlanSetup& setup) {
  const auto along = [](const BenchPlanSetup::Direction& at) {
    return Tangent(at.inclination, at.azimuth);
  };
  std::vector<BenchPlanSetup::Direction> all;
  for (const BenchPlanSetup::Direction& at : setup.hole) {
    if (!all.empty() && (along(at) - along(all.back())).norm() < units::kDeg) continue;
    // Vertical, the way that it leans may be any.
    const int ways = at.inclination < kLeastInclination ? 8 : 1;
    for (int k = 0; k < ways; ++k) all.push_back({at.inclination, at.azimuth + k * kTwoPi / ways});
  }
  if (!all.empty()) return all;
  const bool circle = setup.azimuth_to - setup.azimuth_from > kTwoPi - 1e-3;
  for (const double inc : Between(setup.inclination_from, setup.inclination_to, 7)) {
    for (const double az : Between(setup.azimuth_from, setup.azimuth_to, circle ? 12 : 5, circle)) {
      all.push_back({inc, az});
    }
  }
  return all;
}

// Attitudes of the tool in the hole, at the temperatures that matter.
std::vector<BenchSetting> AttitudesOf(const BenchPlanSetup& setup) {
  std::vector<BenchSetting> all;
  for (const BenchPlanSetup::Direction& at : DirectionsOf(setup)) {
    for (const double tf : Between(0, kTwoPi, 8, true)) {
      for (const double tau : Between(-1, 1, 3)) {
        if (setup.temperatures == 1 && tau != 0) continue;
        all.push_back({std::max(at.inclination, kLeastInclination), at.azimuth, tf, tau});
      }
    }
  }
  return all;
}

// Azimuth by the parameters, a row for each attitude in the hole.
Eigen::MatrixXd HoleOf(const BenchPlanSetup& setup) {
  constexpr double kStep = 1e-5;  // [rad], forward difference: to h / 2 = 5e-6 of the slope
  const double least = 0.5 * kBenchEarthDegPerHour * std::cos(setup.well_latitude);
  const std::vector<BenchSetting> attitudes = AttitudesOf(setup);
  Eigen::MatrixXd hole(static_cast<Eigen::Index>(attitudes.size()), SizeOf(setup));
  Eigen::Index count = 0;
  for (BenchSetting at : attitudes) {
    const Pair rows = RowsOf(at, setup.axes, setup.well_latitude);
    at.azimuth += kStep;
    const Pair turned = RowsOf(at, setup.axes, setup.well_latitude);
    // The rates themselves: sensitivity one.
    const Eigen::Vector2d d(turned(0, 1) - rows(0, 1), turned(1, 6) - rows(1, 6));
    const Eigen::Vector2d slope = d / kStep;
    if (slope.norm() < least) continue;
    hole.row(count++) = (slope.transpose() * rows / slope.squaredNorm()).leftCols(SizeOf(setup));
  }
  if (count < 1) throw std::invalid_argument("no azimuth can be told in this hole");
  return hole.topRows(count);
}

// tr x A x' of each candidate's two rows x.
Eigen::VectorXd PairSums(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& A) {
  const Eigen::VectorXd each = (rows * A).cwiseProduct(rows).rowwise().sum();
  const Eigen::Index n = each.size() / 2;
  return each.reshaped(2, n).colwise().sum().transpose();
}

}  // namespace

BenchDesign DesignOf(const std::vector<BenchSetting>& candidates, const BenchPlanSetup& setup) {
  const int n = SizeOf(setup);
  BenchDesign design{Eigen::MatrixXd(2 * static_cast<Eigen::Index>(candidates.size()), n),
                     HoleOf(setup), Eigen::MatrixXd::Zero(n, n)};
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    design.rows.middleRows<2>(2 * static_cast<Eigen::Index>(k)) =
        RowsOf(candidates[k], setup.axes, setup.bench_latitude).leftCols(n) / setup.sigma_gyro;
  }
  if (!(setup.sigma_sensitivity > 0)) return design;
  for (const int first : {1, 5}) {
    design.before.diagonal().segment<3>(first).setConstant(1 /
                                                           std::pow(setup.sigma_sensitivity, 2));
  }
  return design;
}

Eigen::VectorXd AzimuthVariances(const Eigen::MatrixXd& hole, const Eigen::MatrixXd& cov) {
  return (hole * cov).cwiseProduct(hole).rowwise().sum();
}

DesignWeights OptimalWeights(const BenchDesign& design, double variance, bool largest) {
  // The bound is within one per cent of the optimum by then: 0.4 % in the worst of four parts of
  // all directions, with half as many turns 0.6 %, with twice 0.1 %.
  constexpr int kTurns = 1200;
  const Eigen::Index n = design.rows.rows() / 2, attitudes = design.hole.rows();
  DesignWeights best{Eigen::VectorXd::Constant(n, 100.0 / static_cast<double>(n)), 0};
  Eigen::VectorXd& w = best.weights;
  Eigen::VectorXd mu = Eigen::VectorXd::Constant(attitudes, 1 / static_cast<double>(attitudes));
  for (int turn = 0; turn < kTurns; ++turn) {
    const Eigen::VectorXd twice = w.transpose().replicate(2, 1).reshaped();
    const Eigen::MatrixXd M =
        design.before + design.rows.transpose() * twice.asDiagonal() * design.rows;
    const Eigen::MatrixXd C = InverseOfSymmetric(M);
    const Eigen::VectorXd s = AzimuthVariances(design.hole, C);
    const Eigen::MatrixXd W = design.hole.transpose() * mu.asDiagonal() * design.hole;
    const Eigen::MatrixXd Q = C * W * C;
    const double phi = mu.dot(s);
    const Eigen::VectorXd d = PairSums(design.rows, Q);
    best.fewest =
        std::max(best.fewest, (phi * phi / variance - (design.before * Q).trace()) / d.maxCoeff());
    const double reached = largest ? s.maxCoeff() : phi;
    w = w.cwiseProduct((d * (w.sum() / d.dot(w))).cwiseSqrt()) * (reached / variance);
    if (!largest) continue;
    mu = mu.cwiseProduct((s / s.maxCoeff()).cwiseSqrt());
    mu /= mu.sum();
  }
  return best;
}

}  // namespace wellgyro
