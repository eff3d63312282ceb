#include "wellgyro/fit/bench_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/bench_reference.h"

namespace wellgyro {
namespace {

// Parameters: b and U of two channels, M, Q, N of two; then, where temperatures vary, b tau and
// b tau^2 of two, M tau, Q tau.
constexpr int kPlain = 12, kMost = 18;
using Pair = Eigen::Matrix<double, 2, kMost>;
using Square = Eigen::Matrix<double, kMost, kMost>;

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

// Attitudes of the tool in the hole, at the temperatures that matter.
std::vector<BenchSetting> HoleOf(const BenchPlanSetup& setup) {
  const bool circle = setup.azimuth_to - setup.azimuth_from > kTwoPi - 1e-3;
  std::vector<BenchSetting> all;
  for (const double inc : Between(setup.inclination_from, setup.inclination_to, 7)) {
    for (const double az : Between(setup.azimuth_from, setup.azimuth_to, circle ? 12 : 5, circle)) {
      for (const double tf : Between(0, kTwoPi, 8, true)) {
        for (const double tau : Between(-1, 1, 3)) {
          if (setup.temperatures == 1 && tau != 0) continue;
          all.push_back({inc, az, tf, tau});
        }
      }
    }
  }
  return all;
}

// Azimuth by the parameters, over attitudes in the hole: mean of g g'.
Square WeightOf(const BenchPlanSetup& setup) {
  Square W = Square::Zero();
  double count = 0;
  constexpr double kStep = 1e-5;
  const double least = 0.5 * kBenchEarthDegPerHour * std::cos(setup.well_latitude);
  for (BenchSetting at : HoleOf(setup)) {
    const Pair rows = RowsOf(at, setup.axes, setup.well_latitude);
    at.azimuth += kStep;
    const Pair turned = RowsOf(at, setup.axes, setup.well_latitude);
    // The rates themselves: sensitivity one.
    const Eigen::Vector2d d(turned(0, 1) - rows(0, 1), turned(1, 6) - rows(1, 6));
    const Eigen::Vector2d slope = d / kStep;
    if (slope.norm() < least) continue;
    const Eigen::Matrix<double, kMost, 1> g = rows.transpose() * slope / slope.squaredNorm();
    W += g * g.transpose();
    count += 1;
  }
  if (count < 1) throw std::invalid_argument("no azimuth can be told in this hole");
  return W / count;
}

std::vector<double> TausOf(int temperatures) {
  std::vector<double> taus;
  for (int k = 0; k < temperatures; ++k) {
    taus.push_back(temperatures == 1 ? 0 : -1 + 2.0 * k / (temperatures - 1));
  }
  return taus;
}

std::vector<BenchSetting> CandidateSettings(const BenchPlanSetup& setup) {
  std::vector<BenchSetting> all;
  for (const double tau : TausOf(setup.temperatures)) {
    for (int inc = 0; inc <= 180; inc += 15) {
      for (int az = 0; az < 360; az += 45) {
        for (int tf = 0; tf < 360; tf += 30) {
          // Where the tool is vertical azimuth and toolface are one.
          if ((inc == 0 || inc == 180) && tf > 0) continue;
          all.push_back({FromDegrees(inc), FromDegrees(az), FromDegrees(tf), tau});
        }
      }
    }
  }
  return all;
}

class Design {
 public:
  explicit Design(const BenchPlanSetup& setup)
      : setup_(setup), n_(SizeOf(setup)), candidates_(CandidateSettings(setup)) {
    rows_.reserve(candidates_.size());
    for (const BenchSetting& at : candidates_) {
      rows_.push_back(RowsOf(at, setup.axes, setup.bench_latitude) / setup.sigma_gyro);
      rows_.back().rightCols(kMost - n_).setZero();
    }
    azimuth_ = Used(WeightOf(setup));
    W_ = setup.criterion == BenchPlanSetup::Criterion::kAzimuth ? azimuth_
                                                                : Used(Square::Identity());
    Replace({});
  }

  BenchPlan Find() {
    while (static_cast<int>(chosen_.size()) < setup_.most && !Enough()) Add(Best());
    // Fewer by a twelfth, then one by one.
    for (const std::size_t part : {std::size_t{12}, std::size_t{1000}}) {
      while (Enough()) {
        const std::vector<std::size_t> before = chosen_;
        const std::size_t fewer = std::max<std::size_t>(1, chosen_.size() / part);
        for (std::size_t k = 0; k < fewer; ++k) Remove(Least());
        Exchange();
        if (Enough()) continue;
        Replace(before);
        break;
      }
    }
    BenchPlan plan;
    for (const std::size_t place : chosen_) plan.settings.push_back(candidates_[place]);
    std::sort(plan.settings.begin(), plan.settings.end(),
              [](const BenchSetting& a, const BenchSetting& b) {
                return std::tie(a.tau, a.inclination, a.azimuth, a.toolface) <
                       std::tie(b.tau, b.inclination, b.azimuth, b.toolface);
              });
    plan.sigma_azimuth = Sigma();
    plan.reached = Enough();
    return plan;
  }

 private:
  // Of the parameters that there are.
  Square Used(const Square& all) const {
    Square used = Square::Zero();
    used.topLeftCorner(n_, n_) = all.topLeftCorner(n_, n_);
    return used;
  }
  Square Cov() const {
    Square cov = Square::Zero();
    cov.topLeftCorner(n_, n_) = Eigen::MatrixXd(information_.topLeftCorner(n_, n_))
                                    .llt()
                                    .solve(Eigen::MatrixXd::Identity(n_, n_));
    return cov;
  }
  double Sigma() const { return std::sqrt((Cov() * azimuth_).trace()); }
  bool Enough() const {
    return static_cast<int>(chosen_.size()) >= n_ && Sigma() <= setup_.sigma_azimuth;
  }

  void Add(std::size_t place) {
    chosen_.push_back(place);
    information_ += rows_[place].transpose() * rows_[place];
  }
  void Remove(std::size_t which) {
    const std::size_t place = chosen_[which];
    information_ -= rows_[place].transpose() * rows_[place];
    chosen_.erase(chosen_.begin() + static_cast<std::ptrdiff_t>(which));
  }
  void Replace(const std::vector<std::size_t>& places) {
    chosen_.clear();
    // Nearly nothing is known before.
    information_ = 1e-9 * Square::Identity();
    for (const std::size_t place : places) Add(place);
  }

  // What the criterion falls by with one setting more (sign 1) or rises by with one less (-1).
  double Worth(const Square& C, const Square& CWC, std::size_t place, double sign) const {
    const Pair& X = rows_[place];
    const Eigen::Matrix2d inner = Eigen::Matrix2d::Identity() + sign * (X * C) * X.transpose();
    if (setup_.criterion == BenchPlanSetup::Criterion::kDeterminant) {
      return std::log(std::max(inner.determinant(), 1e-300)) * sign;
    }
    return (inner.inverse() * ((X * CWC) * X.transpose())).trace();
  }

  // The candidate that is worth most.
  std::size_t Best() const {
    const Square C = Cov(), CWC = C * W_ * C;
    std::pair<std::size_t, double> best{0, -1};
    for (std::size_t place = 0; place < rows_.size(); ++place) {
      const double worth = Worth(C, CWC, place, 1);
      if (worth > best.second) best = {place, worth};
    }
    return best.first;
  }

  // The setting that is worth least.
  std::size_t Least() const {
    const Square C = Cov(), CWC = C * W_ * C;
    std::pair<std::size_t, double> least{0, std::numeric_limits<double>::infinity()};
    for (std::size_t k = 0; k < chosen_.size(); ++k) {
      const double worth = Worth(C, CWC, chosen_[k], -1);
      if (worth > 0 && worth < least.second) least = {k, worth};
    }
    return least.first;
  }

  // One setting after the other for a better one, until none is.
  void Exchange() {
    constexpr int kTurns = 5;
    for (int turn = 0; turn < kTurns && !Enough(); ++turn) {
      const double before = Sigma();
      const std::vector<std::size_t> places = chosen_;
      for (std::size_t k = 0; k < places.size(); ++k) {
        Remove(0);
        Add(Best());
      }
      if (Sigma() < before * (1 - 1e-4)) continue;
      if (Sigma() > before) Replace(places);
      break;
    }
  }

  const BenchPlanSetup& setup_;
  int n_;
  std::vector<BenchSetting> candidates_;
  std::vector<Pair> rows_;
  Square W_, azimuth_, information_;
  std::vector<std::size_t> chosen_;
};

void Require(const BenchPlanSetup& setup) {
  if (setup.temperatures < 1 || setup.temperatures > 5) {
    throw std::invalid_argument(
        fmt::format("{} temperatures: 1 to 5 can be planned", setup.temperatures));
  }
  const double inc = setup.inclination_to - setup.inclination_from;
  const double az = setup.azimuth_to - setup.azimuth_from;
  if (!(inc >= 0) || !(az >= 0) || az > kTwoPi + 1e-3) {
    throw std::invalid_argument("inclinations and azimuths of the hole go from less to more");
  }
  if (!(setup.sigma_gyro > 0) || !(setup.sigma_azimuth > 0)) {
    throw std::invalid_argument("a plan needs the sigma of a reading and the azimuth's wanted one");
  }
}

}  // namespace

double AzimuthSigmaOf(const std::vector<BenchSetting>& settings, const BenchPlanSetup& setup) {
  const int n = SizeOf(setup);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (const BenchSetting& at : settings) {
    const Eigen::MatrixXd X =
        RowsOf(at, setup.axes, setup.bench_latitude).leftCols(n) / setup.sigma_gyro;
    information += X.transpose() * X;
  }
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  if (!(eigen.eigenvalues()[0] > 1e-10)) return std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd cov =
      scale.asDiagonal() * Eigen::MatrixXd(scaled.inverse()) * scale.asDiagonal();
  return std::sqrt((cov * WeightOf(setup).topLeftCorner(n, n)).trace());
}

std::vector<BenchSetting> PlainSettings(int temperatures) {
  std::vector<BenchSetting> all;
  for (const double tau : TausOf(temperatures)) {
    for (int inc = 0; inc <= 135; inc += 45) {
      for (int az = 0; az < 360; az += 90) {
        for (int tf = 0; tf < 360; tf += 60) {
          all.push_back({FromDegrees(inc), FromDegrees(az), FromDegrees(tf), tau});
        }
      }
    }
  }
  return all;
}

BenchPlan PlanBench(const BenchPlanSetup& setup) {
  Require(setup);
  return Design(setup).Find();
}

}  // namespace wellgyro
