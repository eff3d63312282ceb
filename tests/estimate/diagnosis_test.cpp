#include "wellgyro/estimate/diagnosis.h"

#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/estimate/onset_scan.h"
#include "wellgyro/estimate/scatter.h"
#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Kind = CauseSpec::Kind;

constexpr int kDenseKnots = 30;

/// A made-up run of random derivatives whose drift steps from node to node, beside it the same as
/// one dense system.
class ToyRun : public RunRows {
 public:
  explicit ToyRun(std::uint64_t seed) : random_(seed) {
    layout_.walk = 6;
    layout_.node = 8;
    layout_.border = 4;
    layout_.source.fill(kAbsent);
    layout_.source[kGyroBiasX] = 0;
    layout_.source[kGyroBiasY] = 1;
    layout_.source[kToolfaceOffset] = 2;
    layout_.latitude = 3;
    layout_.sigma.resize(4);
    layout_.sigma << 1, 2, 0.5, 3;
    // A prior whose errors go together, as a calibration's do: information U'U.
    Eigen::Matrix4d correlation = Eigen::Matrix4d::Identity();
    correlation(0, 1) = correlation(1, 0) = 0.6;
    correlation(1, 3) = correlation(3, 1) = -0.4;
    const auto per_sigma = layout_.sigma.cwiseInverse().asDiagonal();
    layout_.information = per_sigma * correlation.inverse() * per_sigma;
    prior_ = Eigen::Matrix4d(layout_.information).llt().matrixU();
    information_.setZero(12, 12);
    information_.diagonal() << VectorXd::Constant(6, 0.01), 1e6, 1e6, Eigen::Vector4d::Zero();
    information_.bottomRightCorner(4, 4) = layout_.information;
    for (int i = 0; i < 8; ++i) Row(VectorXd::Unit(kUnknowns, i) * std::sqrt(information_(i, i)));
    for (int i = 0; i < 4; ++i) {
      VectorXd row = VectorXd::Zero(kUnknowns);
      row.tail(4) = prior_.row(i);
      Row(row);
    }
    for (int k = 0; k < kDenseKnots; ++k) AddKnot(k);
    border_ = prior_.inverse() * PriorNoise();
  }

  const Layout& layout() const override { return layout_; }
  std::size_t size() const override { return kDenseKnots; }
  void FirstRows(EdgeMatrix& information, EdgeVector& gradient) const override {
    information = information_;
    gradient.resize(12);
    for (int i = 0; i < 8; ++i) gradient[i] = std::sqrt(information_(i, i)) * noise_[i];
    gradient.tail(4) = prior_.transpose() * PriorNoise();
  }
  void RowsOf(std::size_t k, std::vector<Factor>& rows) override {
    rows.insert(rows.end(), factors_[k].begin(), factors_[k].end());
  }

  /// Adds `size` times the column to what was measured.
  void Disturb(const VectorXd& column, double size) {
    for (Eigen::Index i = 0; i < column.size(); ++i) {
      noise_[static_cast<std::size_t>(i)] += size * column[i];
    }
    for (std::vector<Factor>& knot : factors_) {
      for (Factor& f : knot) {
        for (int i = 0; i < f.rows; ++i) f.r[i] = noise_[RowAt(f) + static_cast<std::size_t>(i)];
      }
    }
  }

  MatrixXd J() const {
    MatrixXd j =
        MatrixXd::Zero(static_cast<Eigen::Index>(dense_.size()), (kDenseKnots + 1) * 8 + 4);
    for (std::size_t i = 0; i < dense_.size(); ++i) j.row(static_cast<Eigen::Index>(i)) = dense_[i];
    return j;
  }
  VectorXd r() const { return Eigen::Map<const VectorXd>(noise_.data(), rows()); }
  Eigen::Index rows() const { return static_cast<Eigen::Index>(dense_.size()); }
  /// Column of a step of an unknown of the border from node t on, as written in the header.
  VectorXd Step(int unknown, int t) const {
    VectorXd column = VectorXd::Zero(rows());
    for (std::size_t k = static_cast<std::size_t>(t); k < kDenseKnots; ++k) {
      for (const Factor& f : factors_[k]) {
        column.segment(static_cast<Eigen::Index>(RowAt(f)), f.rows) -=
            ColumnOf(f, layout_, unknown).head(f.rows);
      }
    }
    return column;
  }
  /// Column of what an unknown of the border is beyond its prior.
  VectorXd BeyondPrior(int unknown) const {
    VectorXd column = VectorXd::Zero(rows());
    column.segment<4>(8) = prior_.col(unknown);
    return column;
  }
  /// First row of the first factor of this kind.
  Eigen::Index RowOf(std::size_t knot, RowKind kind) const {
    for (const Factor& f : factors_[knot]) {
      if (f.kind == kind) return static_cast<Eigen::Index>(RowAt(f));
    }
    return -1;
  }

 private:
  // The row's place is kept where the test can find it again.
  static std::size_t RowAt(const Factor& f) { return static_cast<std::size_t>(f.held); }

  Eigen::Vector4d PriorNoise() const { return Eigen::Map<const Eigen::Vector4d>(&noise_[8]); }

  void Row(const VectorXd& row) {
    dense_.push_back(row.transpose());
    noise_.push_back(random_.Normal());
  }

  void AddKnot(int k) {
    std::vector<Factor>& knot = factors_.emplace_back();
    for (const RowKind kind : {RowKind::kTurn, RowKind::kForce, RowKind::kRest, RowKind::kDrift}) {
      Factor f;
      f.Begin(kind, kind == RowKind::kDrift ? 2 : 3);
      f.held = static_cast<double>(dense_.size());
      f.per_unit = 2 + k % 3;
      f.r.setZero();
      if (kind == RowKind::kDrift) {
        for (int i = 0; i < 2; ++i) {
          f.Column(6 + i) = -4 * Eigen::Vector2d::Unit(i);
          f.Column(8 + 6 + i) = 4 * Eigen::Vector2d::Unit(i);
        }
      } else {
        const bool turn = kind == RowKind::kTurn;
        for (int j = 0; j < 6; ++j) f.Column(j) = Normals();
        for (int j = 0; j < 6; ++j) f.Column(8 + j) = Normals();
        for (int i = 0; turn && i < 2; ++i) {
          const Vector3d by_bias = Normals();
          // The drift of a knot is its begin's: a step at a node is then one of the bias.
          f.Column(6 + i) = by_bias;
          f.Column(16 + i) = by_bias;
        }
        f.Column(18) = Normals();
        if (turn) f.Column(19) = Normals();
      }
      for (int i = 0; i < f.rows; ++i) {
        Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero((kDenseKnots + 1) * 8 + 4);
        for (int j = 0; j < f.columns; ++j) {
          const int at = f.column[static_cast<std::size_t>(j)];
          row[at < 16 ? k * 8 + at : (kDenseKnots + 1) * 8 + at - 16] += f.J(i, j);
        }
        dense_.push_back(row);
        noise_.push_back(random_.Normal());
        f.r[i] = noise_.back();
      }
      knot.push_back(f);
    }
  }

  Vector3d Normals() { return {random_.Normal(), random_.Normal(), random_.Normal()}; }

  Random random_;
  Layout layout_;
  static constexpr int kUnknowns = (kDenseKnots + 1) * 8 + 4;
  EdgeMatrix information_;
  Eigen::Matrix4d prior_;  ///< U
  BorderVector border_ = BorderVector::Zero(4);
  std::vector<std::vector<Factor>> factors_;
  std::vector<Eigen::RowVectorXd> dense_;
  std::vector<double> noise_;
};

/// What the header says, by dense matrices.
struct Dense {
  MatrixXd J, N_inverse, P;
  VectorXd r;

  explicit Dense(const ToyRun& run) : J(run.J()), r(run.r()) {
    N_inverse = (J.transpose() * J).inverse();
    P = MatrixXd::Identity(J.rows(), J.rows()) - J * N_inverse * J.transpose();
  }
  double Information(const VectorXd& c) const { return c.dot(P * c); }
  double Size(const VectorXd& c) const { return c.dot(P * r) / Information(c); }
  double LnBayes(const VectorXd& c, double size) const {
    const double s = c.dot(P * r), m = Information(c);
    return s * s / (2 * (m + 1 / (size * size))) - 0.5 * std::log(1 + size * size * m);
  }
  /// Of the end, which is the sum of the slopes times phi.
  Vector3d Shift(const VectorXd& c, const std::vector<Matrix3d>& slopes) const {
    const VectorXd dx = -N_inverse * J.transpose() * c;
    Vector3d end = Vector3d::Zero();
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      end += slopes[k] * dx.segment<3>(static_cast<Eigen::Index>(k) * 8);
    }
    return end;
  }
};

std::vector<Matrix3d> Slopes() {
  std::vector<Matrix3d> slopes;
  Random random(77);
  for (int k = 0; k <= kDenseKnots; ++k) {
    slopes.push_back(Matrix3d::NullaryExpr([&random] { return random.Normal(); }));
  }
  return slopes;
}

const std::vector<CauseSpec> kSpecs{
    {Kind::kConstant, kGyroBiasX, 3}, {Kind::kConstant, kLatitudeError, 5},
    {Kind::kOnset, kGyroBiasX, 3},    {Kind::kOnset, kToolfaceOffset, 2},
    {Kind::kGyroSpike, 0, 4},         {Kind::kRestMotion, 0, 1},
    {Kind::kConstant, kTimeSkew, 1},  {Kind::kTie, 0, 1}};

VectorXd Unit(const Dense& dense, Eigen::Index row, double value) {
  return value * VectorXd::Unit(dense.J.rows(), row);
}

TEST(Diagnosis, IsThatOfTheDenseAlgebra) {
  ToyRun run(3);
  const Dense dense(run);
  const std::vector<Matrix3d> slopes = Slopes();
  const Diagnosis d = Diagnose(run, kSpecs, slopes, 0.01);
  ASSERT_TRUE(d.done);
  const auto same = [&](std::size_t spec, const std::vector<VectorXd>& columns) {
    double mean = 0, best = -HUGE_VAL;
    VectorXd likeliest;
    for (const VectorXd& c : columns) {
      const double ln_bayes = dense.LnBayes(c, kSpecs[spec].size);
      mean += std::exp(ln_bayes) / static_cast<double>(columns.size());
      if (ln_bayes > best) likeliest = c;
      best = std::max(best, ln_bayes);
    }
    const CauseTest& test = d.tests[spec];
    ASSERT_TRUE(test.tested) << spec;
    EXPECT_NEAR(test.ln_bayes, std::log(mean), 1e-8) << spec;
    EXPECT_NEAR(test.size, dense.Size(likeliest), 1e-8) << spec;
    EXPECT_NEAR(test.sigma * test.sigma * dense.Information(likeliest), 1, 1e-8) << spec;
    EXPECT_LT((test.shift_W - test.size * dense.Shift(likeliest, slopes)).norm(), 1e-7) << spec;
  };
  std::vector<VectorXd> bias_steps, toolface_steps, spikes, motions;
  for (int t = 1; t < kDenseKnots; ++t) {
    bias_steps.push_back(run.Step(0, t));
    toolface_steps.push_back(run.Step(2, t));
  }
  for (std::size_t k = 0; k < kDenseKnots; ++k) {
    const double by = 2 + static_cast<double>(k % 3);
    for (int i = 0; i < 2; ++i) {
      spikes.push_back(Unit(dense, run.RowOf(k, RowKind::kTurn) + i, by));
    }
    for (int i = 0; i < 3; ++i) {
      motions.push_back(Unit(dense, run.RowOf(k, RowKind::kRest) + i, by));
    }
  }
  same(0, {run.BeyondPrior(0)});
  same(1, {run.BeyondPrior(3)});
  same(2, bias_steps);
  same(3, toolface_steps);
  same(4, spikes);
  same(5, motions);
  EXPECT_FALSE(d.tests[6].tested);
  EXPECT_FALSE(d.tests[7].tested);
}

TEST(Diagnosis, AStepOfTheBiasIsOneRowOfItsWalk) {
  ToyRun run(4);
  const Dense dense(run);
  for (const int t : {1, 11, 29}) {
    // The walk into node t: second axis, second row.
    const VectorXd row =
        Unit(dense, run.RowOf(static_cast<std::size_t>(t) - 1, RowKind::kDrift) + 1, 4);
    const VectorXd step = run.Step(1, t);
    EXPECT_NEAR(dense.Information(step) / dense.Information(row), 1, 1e-6) << t;
    EXPECT_NEAR(dense.Size(step), dense.Size(row), 1e-6) << t;
  }
}

TEST(Diagnosis, SignaturesCorrelateAsTheyDo) {
  ToyRun run(5);
  const Dense dense(run);
  const Diagnosis d = Diagnose(run, kSpecs, Slopes(), 0.01);
  const std::vector<VectorXd> columns{run.BeyondPrior(0), run.BeyondPrior(3),
                                      run.Step(0, static_cast<int>(d.tests[2].node)),
                                      run.Step(2, static_cast<int>(d.tests[3].node))};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t j = 0; j < columns.size(); ++j) {
      const double rho = columns[i].dot(dense.P * columns[j]) /
                         std::sqrt(dense.Information(columns[i]) * dense.Information(columns[j]));
      EXPECT_NEAR(d.alike(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)), rho, 1e-8);
    }
  }
}

TEST(Diagnosis, FindsWhatWasPutIn) {
  ToyRun run(6);
  run.Disturb(run.Step(2, 12), 6);
  const Diagnosis d = Diagnose(run, kSpecs, Slopes(), 0.01);
  EXPECT_GT(d.ln_odds, std::log(100));
  for (std::size_t i = 0; i < kSpecs.size(); ++i) {
    if (i == 3) continue;
    EXPECT_LT(d.tests[i].ln_bayes, d.tests[3].ln_bayes) << i;
  }
  EXPECT_NEAR(d.tests[3].size, 6, 4 * d.tests[3].sigma);
  EXPECT_NEAR(static_cast<double>(d.tests[3].node), 12, 2);
  EXPECT_LT(d.ln_odds_without_first, std::log(100));
}

// Markov: the mean Bayes factor of runs without fault is one.
TEST(Diagnosis, CleanRunsSeldomAlarm) {
  int alarms = 0;
  double odds = 0;
  constexpr int kRuns = 300;
  for (int seed = 0; seed < kRuns; ++seed) {
    ToyRun run(1000 + static_cast<std::uint64_t>(seed));
    const Diagnosis d = Diagnose(run, kSpecs, Slopes(), 0.05);
    alarms += d.ln_odds > std::log(20) ? 1 : 0;
    odds += std::exp(d.ln_odds) / kRuns;
  }
  // 5 % of 300 and three sigmas of that.
  EXPECT_LE(alarms, 26);
  EXPECT_LT(odds, 3);
  EXPECT_GT(odds, 0.3);
}

// Four times in five, by the definition of the smallest size that is noticed.
TEST(Diagnosis, TheSmallestIsNoticedAsOftenAsItSays) {
  constexpr int kRuns = 200;
  std::vector<CauseSpec> specs = kSpecs;
  specs[3].size = 20;  // so that at every onset some fault of its kind is noticed
  for (const std::size_t spec : {std::size_t{1}, std::size_t{3}}) {
    int noticed = 0;
    const std::vector<Matrix3d> slopes = Slopes();
    for (int seed = 0; seed < kRuns; ++seed) {
      ToyRun run(5000 + static_cast<std::uint64_t>(seed));
      const CauseTest before = Diagnose(run, specs, slopes, 0.01).tests[spec];
      ASSERT_TRUE(before.noticeable);
      const VectorXd column =
          spec == 1 ? run.BeyondPrior(3) : run.Step(2, static_cast<int>(before.smallest_node));
      if (seed == 0) {
        const Dense dense(run);
        EXPECT_NEAR(before.hidden_W.norm(), before.smallest * dense.Shift(column, slopes).norm(),
                    1e-6);
      }
      run.Disturb(column, before.smallest);
      noticed += Diagnose(run, specs, slopes, 0.01).ln_odds > std::log(100) ? 1 : 0;
    }
    EXPECT_NEAR(noticed / static_cast<double>(kRuns), 0.8, 0.12) << spec;
  }
}

TEST(Diagnosis, NoiseIsToldFromABurst) {
  Random random(9);
  Scatter clean(20), burst(20), noisy(20);
  Factor f;
  f.Begin(RowKind::kTurn, 3);
  for (std::size_t k = 0; k < 400; ++k) {
    const Vector3d r{random.Normal(), random.Normal(), random.Normal()};
    f.r = r;
    clean.Add(k, f, Matrix3d::Identity());
    f.r = k / 20 == 7 ? 4 * r : r;
    burst.Add(k, f, Matrix3d::Identity());
    f.r = 1.5 * r;
    noisy.Add(k, f, Matrix3d::Identity());
  }
  CauseTest of_clean, of_noisy;
  clean.TestAll(of_clean);
  noisy.TestAll(of_noisy);
  EXPECT_LT(of_clean.ln_bayes, 0);
  EXPECT_NEAR(of_clean.size, 1, 0.1);
  EXPECT_GT(of_noisy.ln_bayes, 50);
  EXPECT_NEAR(of_noisy.size, 1.5, 0.15);
  EXPECT_LT(clean.Stretches()[7], 2);
  EXPECT_GT(burst.Stretches()[7], 50);
}

// Below this the mean of P's diagonal is mostly the unknowns'.
TEST(Diagnosis, WhatTheUnknownsTakeUpIsNoNoise) {
  Scatter scatter(20);
  Factor f;
  f.Begin(RowKind::kTurn, 3);
  f.r.setConstant(1e-3);
  scatter.Add(0, f, 0.01 * Matrix3d::Identity());
  CauseTest test;
  scatter.TestAll(test);
  EXPECT_FALSE(test.tested);
  EXPECT_TRUE(scatter.Stretches().empty());
}

}  // namespace
}  // namespace wellgyro
