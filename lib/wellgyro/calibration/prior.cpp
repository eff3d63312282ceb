#include "wellgyro/calibration/prior.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/calibration/group_at_internal.h"
#include "wellgyro/calibration/members.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Members {
  std::vector<std::string> names;
  VectorXd values;
  MatrixXd cov;
};

Members MembersOf(const ToolCalibration& tool) {
  const SensorGroup& group = HasMembers(tool.gyro) ? tool.gyro : tool.accel;
  if (!HasMembers(group)) {
    throw std::invalid_argument(
        "a prior joins tool files with the covariance that calibrate tool writes");
  }
  Members members{group.covariance->names, VectorXd(group.covariance->cov.rows()),
                  group.covariance->cov};
  for (Index k = 0; k < members.values.size(); ++k) {
    members.values[k] = ValueOf(tool, MemberOf(members.names[static_cast<std::size_t>(k)]));
  }
  return members;
}

double Binomial(int n, int k) {
  double value = 1;
  for (int i = 1; i <= k; ++i) value *= static_cast<double>(n - k + i) / i;
  return value;
}

// Of the members of a prior those of `tool`'s, linearly: a polynomial in the prior's temperature
// scale is one in the tool's, whose coefficients each take from its own and the higher ones.
MatrixXd InScaleOf(const ToolCalibration& tool, const ToolCalibration& prior,
                   const std::vector<std::string>& wanted, const std::vector<std::string>& known) {
  MatrixXd T = MatrixXd::Zero(static_cast<Index>(wanted.size()), static_cast<Index>(known.size()));
  for (Index i = 0; i < T.rows(); ++i) {
    const CalibrationMember to = MemberOf(wanted[static_cast<std::size_t>(i)]);
    const SensorGroup& group = to.is_gyro ? tool.gyro : tool.accel;
    const SensorGroup& before = to.is_gyro ? prior.gyro : prior.accel;
    const double stretch = group.half_range / before.half_range;
    const double shift = (group.reference - before.reference) / before.half_range;
    for (Index j = 0; j < T.cols(); ++j) {
      const CalibrationMember from = MemberOf(known[static_cast<std::size_t>(j)]);
      if (from.is_gyro != to.is_gyro || from.kind != to.kind || from.channel != to.channel ||
          from.column != to.column || from.power < to.power) {
        continue;
      }
      T(i, j) = Binomial(from.power, to.power) * std::pow(stretch, to.power) *
                std::pow(shift, from.power - to.power);
    }
  }
  return T;
}

void RequireAlike(const ToolCalibration& tool, const ToolCalibration& prior) {
  for (auto member : {&ToolCalibration::gyro, &ToolCalibration::accel}) {
    const SensorGroup &a = tool.*member, &b = prior.*member;
    if (a.n_channels == b.n_channels && a.R_TS.isApprox(b.R_TS, 1e-9) && a.unit == b.unit) continue;
    throw std::invalid_argument(
        "the prior's tool has other channels, axes or units: it is no prior of this one");
  }
}

// Lower tail of chi-square of what every calibration finds: biases, sensitivities and force terms
// at the reference temperature. Terms that the choice leaves out are taken at nearly the same means
// by any two benches, and their doubt makes chi-square of all members small without shared
// readings.
double Likeness(const std::vector<std::string>& names, const VectorXd& d, const MatrixXd& S) {
  using Of = CalibrationMember::Kind;
  std::vector<Index> found;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const CalibrationMember member = MemberOf(names[i]);
    const bool plain =
        member.kind == Of::kBias || member.kind == Of::kSensitivity || member.kind == Of::kForce;
    if (plain && member.power == 0) found.push_back(static_cast<Index>(i));
  }
  if (found.empty()) return 1;
  const VectorXd known = d(found);
  const double chi_square = known.dot(SolveSymmetric(S(found, found), known).col(0));
  return ChiSquareCdf(chi_square, static_cast<double>(found.size()));
}

// Of x = own + K (known before - own of these), K's columns being the common members'.
void TellContributions(const MatrixXd& K, const std::vector<Index>& common, const MatrixXd& before,
                       JoinedTool& joined) {
  joined.cov_by_prior = K * before * K.transpose();
  joined.by_bench = MatrixXd::Identity(K.rows(), K.rows());
  joined.by_bench(Eigen::all, common) -= K;
}

}  // namespace

bool RestsOn(const ToolCalibration& tool, const std::string& sha256) {
  return std::find(tool.rests_on.begin(), tool.rests_on.end(), sha256) != tool.rests_on.end();
}

JoinedTool JoinPrior(ToolCalibration tool, const ToolCalibration& prior) {
  RequireAlike(tool, prior);
  Members own = MembersOf(tool);
  const Members before = MembersOf(prior);
  std::vector<Index> common;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < own.names.size(); ++i) {
    if (std::find(before.names.begin(), before.names.end(), own.names[i]) == before.names.end()) {
      continue;
    }
    common.push_back(static_cast<Index>(i));
    names.push_back(own.names[i]);
  }
  const MatrixXd T = InScaleOf(tool, prior, names, before.names);
  // In sigmas of the bench: members differ by many orders of magnitude.
  const VectorXd per_sigma = own.cov.diagonal()(common).cwiseSqrt().cwiseInverse();
  const VectorXd d = per_sigma.cwiseProduct(T * before.values - own.values(common));
  const MatrixXd of_own = own.cov(Eigen::all, common) * per_sigma.asDiagonal();
  const MatrixXd both = own.cov(common, common) + T * before.cov * T.transpose();
  const MatrixXd S = per_sigma.asDiagonal() * both * per_sigma.asDiagonal();
  const MatrixXd gain = SolveSymmetric(S, of_own.transpose()).transpose();
  JoinedTool joined{std::move(tool), d.dot(SolveSymmetric(S, d).col(0)),
                    static_cast<int>(common.size())};
  joined.probability = 1 - ChiSquareCdf(joined.chi_square, joined.dof);
  joined.likeness = Likeness(names, d, S);
  own.values += gain * d;
  own.cov -= gain * of_own.transpose();
  joined.members = own.names;
  TellContributions(gain * per_sigma.asDiagonal(), common, T * before.cov * T.transpose(), joined);
  for (Index k = 0; k < own.values.size(); ++k) {
    ValueOf(joined.tool, MemberOf(own.names[static_cast<std::size_t>(k)])) = own.values[k];
  }
  SensorGroup& group = HasMembers(joined.tool.gyro) ? joined.tool.gyro : joined.tool.accel;
  group.covariance->cov = (own.cov + own.cov.transpose()) / 2;
  joined.tool.rests_on_prior = true;
  for (const std::string& readings : prior.rests_on) {
    if (!RestsOn(joined.tool, readings)) joined.tool.rests_on.push_back(readings);
  }
  joined.tool.errors = ErrorsLeft(joined.tool, joined.tool.errors.value_or(ErrorPriors{}));
  return joined;
}

}  // namespace wellgyro
