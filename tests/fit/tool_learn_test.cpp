// What runs teach of their tool, and what was known of it before, joined with what a bench finds.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/calibration/apply.h"
#include "wellgyro/calibration/errors_in_use.h"
#include "wellgyro/calibration/lessons.h"
#include "wellgyro/calibration/members.h"
#include "wellgyro/calibration/prior.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/simulate/raw_counts.h"

#include "fit/tool_bench.h"
#include "fit/tool_model_truth.h"

namespace wellgyro::test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Kind = CalibrationMember::Kind;

VectorXd Normals(Index n, Random& random) {
  VectorXd z(n);
  for (double& value : z) value = random.Normal();
  return z;
}

// Biases and sensitivities at two powers, force terms: all of them correlated.
ParameterCovariance AnyKnown(Random& random) {
  ParameterCovariance known;
  std::vector<double> sigma;
  const auto add = [&](const CalibrationMember& member, double s) {
    known.names.push_back(NameOf(member));
    sigma.push_back(s);
  };
  for (int power = 0; power < 2; ++power) {
    for (int c = 0; c < 4; ++c) {
      add({true, Kind::kBias, power, c, 0}, 0.05);
      for (int j = 0; j < 3; ++j) add({true, Kind::kForce, power, c, j}, 0.02 / kG);
    }
    for (int c = 0; c < 3; ++c) {
      add({false, Kind::kBias, power, c, 0}, 5e-5);
      for (int j = 0; j < 3; ++j) add({false, Kind::kSensitivity, power, c, j}, 3e-5 / kG);
    }
  }
  const auto n = static_cast<Index>(sigma.size());
  MatrixXd root = MatrixXd::Identity(n, n);
  for (double& element : root.reshaped()) element += 0.1 * random.Normal();
  const VectorXd s = Eigen::Map<const VectorXd>(sigma.data(), n);
  known.cov = s.asDiagonal() * root * root.transpose() * s.asDiagonal();
  return known;
}

// `truth` as a bench of this covariance finds it.
ToolCalibration Found(ToolCalibration truth, const ParameterCovariance& known, Random& random) {
  const MatrixXd L = known.cov.llt().matrixL();
  const VectorXd move = L * Normals(L.cols(), random);
  for (Index k = 0; k < move.size(); ++k) {
    ValueOf(truth, MemberOf(known.names[static_cast<std::size_t>(k)])) += move[k];
  }
  truth.gyro.covariance = known;
  return truth;
}

VectorXd ErrorOf(const ToolCalibration& tool, const ToolCalibration& truth) {
  const auto& names = tool.gyro.covariance->names;
  VectorXd error(static_cast<Index>(names.size()));
  for (Index k = 0; k < error.size(); ++k) {
    const CalibrationMember member = MemberOf(names[static_cast<std::size_t>(k)]);
    error[k] = ValueOf(tool, member) - ValueOf(truth, member);
  }
  return error;
}

double Square(const VectorXd& error, const MatrixXd& cov) {
  const VectorXd per = cov.diagonal().cwiseSqrt().cwiseInverse();
  const VectorXd e = per.cwiseProduct(error);
  return e.dot(MatrixXd(per.asDiagonal() * cov * per.asDiagonal()).ldlt().solve(e));
}

// A run at one temperature and inclination whose estimator sees some sums of the errors to a fifth
// of their sigmas, by the formulas of least squares alone.
RunLesson LessonOf(const ToolCalibration& tool, const ToolCalibration& truth, const ToolUse& use,
                   Random& random) {
  RunLesson lesson;
  lesson.uses = {use};
  lesson.cov_before = ErrorsInUse(tool, lesson.uses)->constant;
  const MatrixXd E = ErrorEffects(tool, tool.gyro.covariance->names, lesson.uses);
  const MatrixXd cov = tool.gyro.covariance->cov;
  // What varies with the toolface is drawn too: the run takes it for bias.
  VectorXd errors = E * ErrorOf(tool, truth);
  const VectorXd rest =
      (lesson.cov_before - E * cov * E.transpose()).diagonal().cwiseMax(0).cwiseSqrt();
  errors += rest.cwiseProduct(Normals(errors.size(), random));
  std::vector<Index> known;
  for (Index i = 0; i < kErrorSources; ++i) {
    if (lesson.cov_before(i, i) > 0) known.push_back(i);
  }
  const MatrixXd before = lesson.cov_before(known, known);
  MatrixXd H(6, before.cols());
  for (double& element : H.reshaped()) element = random.Normal();
  H *= before.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
  constexpr double kSigma = 0.2;
  const VectorXd y = H * errors(known) + kSigma * Normals(6, random);
  MatrixXd S = H * before * H.transpose();
  S.diagonal().array() += kSigma * kSigma;
  const MatrixXd gain = S.ldlt().solve(H * before).transpose();
  const VectorXd found = gain * y;
  const MatrixXd after = before - gain * S * gain.transpose();
  for (std::size_t i = 0; i < known.size(); ++i) {
    lesson.errors[known[i]] = found[static_cast<Index>(i)];
    for (std::size_t j = 0; j < known.size(); ++j) {
      lesson.cov(known[i], known[j]) = after(static_cast<Index>(i), static_cast<Index>(j));
    }
  }
  return lesson;
}

void ExpectInBand(double square, double n, const char* what) {
  std::printf("%s: squares over their number %.3f of %.0f\n", what, square / n, n);
  EXPECT_GT(square, ChiSquareQuantile(0.001, n)) << what;
  EXPECT_LT(square, ChiSquareQuantile(0.999, n)) << what;
}

TEST(ToolLearn, WhatRunsTeachIsRightToItsCovariance) {
  Random random(61);
  constexpr int kTools = 40;
  double before = 0, after = 0, number = 0, narrower = 0;
  for (int t = 0; t < kTools; ++t) {
    const ToolCalibration truth = ModelOf(ThermalTool::Any(random));
    const ToolCalibration tool = Found(truth, AnyKnown(random), random);
    std::vector<RunLesson> lessons;
    for (const auto& [T, f] : {std::pair{60.0, -9.0}, {90.0, -6.0}, {120.0, -2.0}}) {
      lessons.push_back(LessonOf(tool, truth, {1, T, 0, f}, random));
    }
    const ToolCalibration taught = Taught(tool, lessons);
    before += Square(ErrorOf(tool, truth), tool.gyro.covariance->cov);
    after += Square(ErrorOf(taught, truth), taught.gyro.covariance->cov);
    number += static_cast<double>(tool.gyro.covariance->names.size());
    const std::vector<ToolUse> use = {{1, 90, 0, -6}};
    narrower += ErrorsInUse(taught, use)->constant(kGyroBiasX, kGyroBiasX) /
                ErrorsInUse(tool, use)->constant(kGyroBiasX, kGyroBiasX) / kTools;
    EXPECT_EQ(taught.gyro.covariance->names, tool.gyro.covariance->names);
    EXPECT_LT(taught.errors->accel_bias_sigma, 1);
  }
  ExpectInBand(before, number, "by the bench");
  ExpectInBand(after, number, "with three runs");
  EXPECT_LT(narrower, 0.8);
}

// Calibrated samples of `raw` less the truth.
ImuSample ErrorOfSample(const ToolCalibration& tool, RawCounter& counter, ImuSample truth) {
  truth.stamp.period_ns = 10'000'000;
  const RawSample raw = counter.Count(truth, 95);
  ImuSample out;
  SampleCalibrator calibrator(tool);
  EXPECT_EQ(calibrator.Apply({&raw, 1}, {&out, 1}), 1u);
  out.w_IT_T -= truth.w_IT_T;
  out.f_T -= truth.f_T;
  return out;
}

// What the errors `e` do to a sample, as the estimator has it (record/error_source.h).
ImuSample ErrorBy(const ErrorVector& e, bool gyros, const ImuSample& at) {
  const Eigen::Vector3d &w = at.w_IT_T, &f = at.f_T;
  ImuSample error;
  Eigen::Matrix3d A;
  const double turned = e[kToolfaceOffset];
  if (gyros) {
    A << e[kGyroScaleX], e[kGyroShear] - turned, e[kMisalignmentX], e[kGyroShear] + turned,
        e[kGyroScaleY], e[kMisalignmentY], e[kGyroMisalignmentZX], e[kGyroMisalignmentZY],
        e[kGyroScaleZ];
    const double s = e[kUnbalanceDifference], t = e[kQuadratureSum];
    error.w_IT_T = e.segment<3>(kGyroBiasX) + A * w;
    error.w_IT_T.z() = (A * w).z();
    error.w_IT_T.x() += (e[kMassUnbalance] + s) * f.x() + (e[kQuadrature] + t) * f.y();
    error.w_IT_T.y() += (e[kMassUnbalance] - s) * f.y() + (t - e[kQuadrature]) * f.x();
    return error;
  }
  A << e[kAccelScaleX], e[kAccelShear] + turned, e[kAccelMisalignmentX], e[kAccelShear] - turned,
      e[kAccelScaleY], e[kAccelMisalignmentY], e[kAccelMisalignmentZX], e[kAccelMisalignmentZY],
      e[kAccelScaleZ];
  const double q[] = {f.x() * f.x(), f.y() * f.y(), f.z() * f.z(),
                      f.x() * f.y(), f.y() * f.z(), f.z() * f.x()};
  error.f_T = e.segment<3>(kAccelBiasX) + A * f;
  for (int i = 0; i < kSecondOrderSources; ++i) {
    error.f_T[i / 6] += e[kAccelSecondOrder + i] * q[i % 6];
  }
  return error;
}

// Gyros or accelerometers wrong, whatever their members: the samples are wrong by what the errors
// in use say, at every toolface. Of a third axis, what it feels of the force is no error of these.
TEST(ToolLearn, ErrorsInUseAreThoseOfCalibratedSamples) {
  for (const bool gyros : {true, false}) {
    Random random(65);
    ToolCalibration truth = ModelOf(ThermalTool::Any(random));
    truth.gyro.heating.setZero();
    truth.gyro.unit_per_count.setConstant(1e-4);
    truth.accel.unit_per_count.setConstant(1e-9);
    ParameterCovariance known;
    for (const auto& name : AnyKnown(random).names) {
      if (MemberOf(name).is_gyro == gyros) known.names.push_back(name);
    }
    for (int c = 0; c < 3 && !gyros; ++c) {
      for (int j = 0; j < 6; ++j)
        known.names.push_back(NameOf({false, Kind::kSecondOrder, 0, c, j}));
    }
    const auto n = static_cast<Index>(known.names.size());
    known.cov = MatrixXd::Identity(n, n);
    ToolCalibration tool = truth;
    for (const auto& name : known.names) {
      const CalibrationMember member = MemberOf(name);
      ValueOf(tool, member) += (gyros ? 0.05 : 2e-5 / kG) / kG * random.Normal();
    }
    tool.gyro.covariance = known;
    const double z = -kG * std::cos(0.9);
    const std::vector<ToolUse> use = {{1, 95, 0, z}};
    const ErrorVector e = ErrorEffects(tool, known.names, use) * ErrorOf(tool, truth);
    RawCounter counter(truth);
    for (int k = 0; k < 12; ++k) {
      const double toolface = 0.5 * k, across = kG * std::sin(0.9);
      ImuSample still, at;
      still.f_T = at.f_T = {across * std::cos(toolface), -across * std::sin(toolface), z};
      at.w_IT_T = {2e-3, -1e-3, 0.3};
      const ImuSample expected = ErrorBy(e, gyros, at), found = ErrorOfSample(tool, counter, at);
      if (gyros) {
        const Eigen::Vector3d w = found.w_IT_T - Eigen::Vector3d(0, 0, 1).cwiseProduct(
                                                     ErrorOfSample(tool, counter, still).w_IT_T);
        EXPECT_LT((w - expected.w_IT_T).norm(), 0.01 * expected.w_IT_T.norm()) << k;
      } else {
        EXPECT_LT((found.f_T - expected.f_T).norm(), 0.01 * expected.f_T.norm()) << k;
      }
    }
  }
}

// A run that learnt nothing teaches nothing.
TEST(ToolLearn, ARunThatSawNothingLeavesTheToolAsItWas) {
  Random random(62);
  const ToolCalibration truth = ModelOf(ThermalTool::Any(random));
  const ToolCalibration tool = Found(truth, AnyKnown(random), random);
  RunLesson lesson;
  lesson.uses = {{1, 80, 0, -5}};
  lesson.cov = lesson.cov_before = ErrorsInUse(tool, lesson.uses)->constant;
  const ToolCalibration taught = Taught(tool, std::vector{lesson});
  EXPECT_TRUE(taught.rests_on_prior);
  EXPECT_EQ(ErrorOf(taught, tool).norm(), 0);
  EXPECT_TRUE(taught.gyro.covariance->cov.isApprox(tool.gyro.covariance->cov, 1e-12));
  EXPECT_THROW(Taught(truth, std::vector{lesson}), std::invalid_argument);
}

// The same tool in another scale of temperature.
ToolCalibration Rescaled(ToolCalibration tool, double reference, double half_range) {
  for (SensorGroup* group : {&tool.gyro, &tool.accel}) {
    const double a = half_range / group->half_range;
    const double b = (reference - group->reference) / group->half_range;
    const auto rescale = [&](auto& p) {
      const auto old = p;
      p[0] = old[0] + b * old[1] + b * b * old[2] + b * b * b * old[3];
      p[1] = a * (old[1] + 2 * b * old[2] + 3 * b * b * old[3]);
      p[2] = a * a * (old[2] + 3 * b * old[3]);
      p[3] = a * a * a * old[3];
    };
    rescale(group->bias);
    rescale(group->sensitivity);
    rescale(group->g_dependence);
    group->reference = reference;
    group->half_range = half_range;
  }
  return tool;
}

// Two benches of other temperature ranges: joined, better than either and right to its covariance.
TEST(ToolLearn, ABenchIsJoinedWithWhatWasKnownBefore) {
  Random random(63);
  constexpr int kTools = 40;
  double square = 0, number = 0, chi_square = 0, dof = 0;
  for (int t = 0; t < kTools; ++t) {
    ThermalTool thermal = ThermalTool::Any(random);
    // Of powers that both benches have: a bench says nothing of a truth that it has no member for.
    for (int n = 2; n < 4; ++n) thermal.ba[n].setZero(), thermal.bg[n].setZero();
    const ToolCalibration truth = ModelOf(thermal), other = Rescaled(truth, 80, 50);
    const ToolCalibration bench = Found(truth, AnyKnown(random), random);
    const ToolCalibration earlier = Found(other, AnyKnown(random), random);
    const JoinedTool joined = JoinPrior(bench, earlier);
    EXPECT_TRUE(joined.tool.rests_on_prior);
    square += Square(ErrorOf(joined.tool, truth), joined.tool.gyro.covariance->cov);
    number += static_cast<double>(bench.gyro.covariance->names.size());
    chi_square += joined.chi_square;
    dof += joined.dof;
    EXPECT_GT(joined.probability, 1e-5);
    const VectorXd narrower = joined.tool.gyro.covariance->cov.diagonal().cwiseQuotient(
        bench.gyro.covariance->cov.diagonal());
    EXPECT_LT(narrower.maxCoeff(), 1);
    EXPECT_LT(narrower.mean(), 0.75);
  }
  ExpectInBand(square, number, "joined");
  ExpectInBand(chi_square, dof, "differences");
}

TEST(ToolLearn, AToolThatChangedIsNoPrior) {
  Random random(64);
  const ToolCalibration truth = ModelOf(ThermalTool::Any(random));
  ToolCalibration changed = truth;
  changed.gyro.bias[0][2] += 1;
  const ParameterCovariance known = AnyKnown(random);
  const ToolCalibration bench = Found(changed, known, random);
  const JoinedTool joined = JoinPrior(bench, Found(truth, known, random));
  EXPECT_LT(joined.probability, 1e-6);
  ToolCalibration turned = Found(truth, known, random);
  turned.accel.R_TS.setIdentity();
  EXPECT_THROW(JoinPrior(turned, Found(truth, known, random)), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro::test
