#include "wellgyro/estimate/diagnosis.h"

#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/estimate/scatter.h"
#include "wellgyro/math/random.h"

#include "estimate/toy_run.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Kind = CauseSpec::Kind;
using test::DenseDiagnosis;
using test::kDenseKnots;
using test::Slopes;
using test::ToyRun;

const std::vector<CauseSpec> kSpecs{
    {Kind::kConstant, kGyroBiasX, 3}, {Kind::kConstant, kLatitudeError, 5},
    {Kind::kOnset, kGyroBiasX, 3},    {Kind::kOnset, kToolfaceOffset, 2},
    {Kind::kGyroSpike, 0, 4},         {Kind::kRestMotion, 0, 1},
    {Kind::kConstant, kTimeSkew, 1},  {Kind::kTie, 0, 1}};

VectorXd Unit(const DenseDiagnosis& dense, Eigen::Index row, double value) {
  return value * VectorXd::Unit(dense.J.rows(), row);
}

TEST(Diagnosis, IsThatOfTheDenseAlgebra) {
  ToyRun run(3);
  const DenseDiagnosis dense(run);
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
  const DenseDiagnosis dense(run);
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
  const DenseDiagnosis dense(run);
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

/// Every column of a spec, in a run of kDenseKnots; empty of one that nothing tests.
std::vector<VectorXd> ColumnsOf(const ToyRun& run, const DenseDiagnosis& dense, std::size_t spec) {
  std::vector<VectorXd> columns;
  if (spec == 0) columns.push_back(run.BeyondPrior(0));
  if (spec == 1) columns.push_back(run.BeyondPrior(3));
  for (int t = 1; t < kDenseKnots; ++t) {
    if (spec == 2) columns.push_back(run.Step(0, t));
    if (spec == 3) columns.push_back(run.Step(2, t));
  }
  for (std::size_t k = 0; k < kDenseKnots; ++k) {
    const double by = 2 + static_cast<double>(k % 3);
    for (int i = 0; i < 2 && spec == 4; ++i) {
      columns.push_back(Unit(dense, run.RowOf(k, RowKind::kTurn) + i, by));
    }
    for (int i = 0; i < 3 && spec == 5; ++i) {
      columns.push_back(Unit(dense, run.RowOf(k, RowKind::kRest) + i, by));
    }
  }
  return columns;
}

/// Mean Bayes factor of the specs that are listed.
double LnOdds(const ToyRun& run, const DenseDiagnosis& dense, const std::vector<std::size_t>& of) {
  double odds = 0;
  for (const std::size_t spec : of) {
    const std::vector<VectorXd> columns = ColumnsOf(run, dense, spec);
    for (const VectorXd& c : columns) {
      odds += std::exp(dense.LnBayes(c, kSpecs[spec].size)) /
              static_cast<double>(columns.size() * of.size());
    }
  }
  return std::log(odds);
}

struct TakenOut {
  std::size_t first;
  std::vector<std::size_t> others;  ///< of another unknown, or another kind
};

// P of a run in which c is an unknown is P - P c c'P / c'P c.
TEST(Diagnosis, TheSecondLookIsThatOfTheDenseAlgebra) {
  for (const TakenOut& taken : {TakenOut{1, {0, 2, 3, 4, 5}}, TakenOut{2, {1, 3, 4, 5}},
                                TakenOut{4, {0, 1, 2, 3, 5}}, TakenOut{5, {0, 1, 2, 3, 4}}}) {
    ToyRun run(11);
    const std::vector<VectorXd> columns = ColumnsOf(run, DenseDiagnosis(run), taken.first);
    const VectorXd& put = columns[columns.size() / 3];
    run.Disturb(put, 30 / put.norm());
    DenseDiagnosis dense(run);
    const Diagnosis d = Diagnose(run, kSpecs, Slopes(), 0.01);
    ASSERT_TRUE(d.first) << taken.first;
    ASSERT_EQ(*d.first, taken.first);
    const VectorXd c = dense.P * put;
    dense.P -= (c * c.transpose() / put.dot(c)).eval();
    // The size keeps a prior sigma of a hundred sizes.
    EXPECT_NEAR(d.ln_odds_without_first, LnOdds(run, dense, taken.others), 2e-3) << taken.first;
  }
}

TEST(Diagnosis, ASizeThatIsGivenIsTestedAsThat) {
  ToyRun run(12);
  const std::vector<CauseSpec> specs{{Kind::kConstant, kGyroBiasX, 3},
                                     {Kind::kGiven, kGyroBiasX, 8}};
  const VectorXd c = run.BeyondPrior(0);
  run.Disturb(c, 8);
  const DenseDiagnosis dense(run);
  const Diagnosis d = Diagnose(run, specs, Slopes(), 0.01);
  EXPECT_NEAR(d.tests[1].ln_bayes, 8 * c.dot(dense.P * run.r()) - 32 * dense.Information(c), 1e-8);
  EXPECT_EQ(d.tests[1].size, 8);
}

// A column that the largest fault moves by less than a sigma is mostly noise of what it is made of,
// as the scale of an accelerometer that reads nothing: size 1, of any sigma.
TEST(Diagnosis, WhatTheRunHardlyTellsIsNoEvidence) {
  ToyRun run(12);
  const VectorXd c = run.BeyondPrior(0);
  run.Disturb(c, 8);
  const double sigma = 1 / std::sqrt(DenseDiagnosis(run).Information(c));
  const auto tested = [&](double size) {
    const std::vector<CauseSpec> specs{{Kind::kConstant, kGyroBiasX, size}};
    return Diagnose(run, specs, Slopes(), 0.01).tests[0];
  };
  const CauseTest small = tested(0.19 * sigma), large = tested(0.21 * sigma);
  EXPECT_TRUE(small.tested && large.tested && large.told);
  EXPECT_FALSE(small.told);
  EXPECT_EQ(small.ln_bayes, 0);
  EXPECT_GT(large.ln_bayes, 0.1);
  EXPECT_FALSE(small.noticeable);
}

// Two faults of different unknowns: neither alone explains the run.
TEST(Diagnosis, ASecondFaultIsLeft) {
  ToyRun run(13);
  run.Disturb(run.Step(2, 12), 8);
  EXPECT_LT(Diagnose(run, kSpecs, Slopes(), 0.01).ln_odds_without_first, std::log(100));
  run.Disturb(run.BeyondPrior(3), 30);
  EXPECT_GT(Diagnose(run, kSpecs, Slopes(), 0.01).ln_odds_without_first, std::log(100));
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
        const DenseDiagnosis dense(run);
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
