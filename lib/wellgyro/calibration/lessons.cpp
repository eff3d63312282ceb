#include "wellgyro/calibration/lessons.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/calibration/errors_in_use.h"
#include "wellgyro/calibration/group_at_internal.h"
#include "wellgyro/calibration/members.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// What is observed of the run's errors: y = A e + noise, rows independent.
struct Observed {
  MatrixXd A;
  VectorXd y, variance;
};

// The run's posterior over its prior: in directions where both are diagonal, a variance w of a
// prior of one is an observation of variance w / (1 - w).
Observed ObservedBy(const RunLesson& lesson, const std::vector<Eigen::Index>& known) {
  const MatrixXd before = lesson.cov_before(known, known), after = lesson.cov(known, known);
  const VectorXd sigma = before.diagonal().cwiseSqrt();
  const VectorXd per_sigma = sigma.cwiseInverse();
  const Cholesky root(per_sigma.asDiagonal() * before * per_sigma.asDiagonal());
  const MatrixXd to_unit = root.Whitened(MatrixXd(per_sigma.asDiagonal()));
  const SymmetricEigen eigen = EigenOfSymmetric(to_unit * after * to_unit.transpose());
  const MatrixXd A = eigen.vectors.transpose() * to_unit;
  const VectorXd found = A * lesson.errors(known);
  // 1 - w, of which the run says nothing: its observation's variance would be 1000 of the prior's.
  constexpr double kLeast = 1e-3;
  std::vector<Eigen::Index> told;
  for (Eigen::Index k = 0; k < found.size(); ++k) {
    if (1 - eigen.values[k] > kLeast) told.push_back(k);
  }
  const VectorXd w = eigen.values(told).cwiseMax(0);
  const VectorXd taken = (1 - w.array()).matrix();
  return {A(told, Eigen::all), found(told).cwiseQuotient(taken), w.cwiseQuotient(taken)};
}

// The part of the run's prior that the members do not make, none of it negative.
MatrixXd Beyond(const MatrixXd& before, const MatrixXd& of_members) {
  const VectorXd sigma = before.diagonal().cwiseSqrt(), per_sigma = sigma.cwiseInverse();
  const SymmetricEigen eigen =
      EigenOfSymmetric(per_sigma.asDiagonal() * (before - of_members) * per_sigma.asDiagonal());
  const VectorXd values = eigen.values.cwiseMax(0);
  const MatrixXd V = sigma.asDiagonal() * eigen.vectors;
  return V * values.asDiagonal() * V.transpose();
}

// The errors of a model's members, its own less the true ones.
struct MemberErrors {
  VectorXd mean;
  MatrixXd cov;
};

void Learn(const ToolCalibration& tool, const ParameterCovariance& first, const RunLesson& lesson,
           MemberErrors& errors) {
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < kErrorSources; ++i) {
    if (lesson.cov_before(i, i) > 0) known.push_back(i);
  }
  if (known.empty()) return;
  const MatrixXd E = ErrorEffects(tool, first.names, lesson.uses)(known, Eigen::all);
  const Observed observed = ObservedBy(lesson, known);
  const MatrixXd H = observed.A * E;
  const MatrixXd beyond = Beyond(lesson.cov_before(known, known), E * first.cov * E.transpose());
  MatrixXd S = H * errors.cov * H.transpose() + observed.A * beyond * observed.A.transpose();
  S.diagonal() += observed.variance;
  const MatrixXd gain = SolveSymmetric(S, H * errors.cov).transpose();
  errors.mean += gain * (observed.y - H * errors.mean);
  errors.cov -= gain * S * gain.transpose();
  errors.cov = ((errors.cov + errors.cov.transpose()) / 2).eval();
}

}  // namespace

ToolCalibration Taught(ToolCalibration tool, std::span<const RunLesson> lessons) {
  SensorGroup& group = HasMembers(tool.gyro) ? tool.gyro : tool.accel;
  if (!HasMembers(group)) {
    throw std::invalid_argument(
        "the tool has no covariance of its members, which calibrate tool writes: what runs found "
        "cannot be joined with it");
  }
  const ParameterCovariance first = *group.covariance;
  MemberErrors errors{VectorXd::Zero(first.cov.rows()), first.cov};
  const ToolCalibration used = tool;
  for (const RunLesson& lesson : lessons) Learn(used, first, lesson, errors);
  for (Eigen::Index k = 0; k < errors.mean.size(); ++k) {
    ValueOf(tool, MemberOf(first.names[static_cast<std::size_t>(k)])) -= errors.mean[k];
  }
  group.covariance->cov = errors.cov;
  tool.rests_on_prior = true;
  tool.errors = ErrorsLeft(tool, tool.errors.value_or(ErrorPriors{}));
  return tool;
}

}  // namespace wellgyro
