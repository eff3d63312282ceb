#include "wellgyro/calibration/errors_in_use.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/group_at_internal.h"
#include "wellgyro/calibration/members.h"

namespace wellgyro {
namespace {

using Kind = CalibrationMember::Kind;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Errors of one group of sensors: b + A u + G f, and the part of the squares of the force that goes
// by cosine and sine of twice the toolface.
struct GroupError {
  Vector3d b = Vector3d::Zero();
  Matrix3d A = Matrix3d::Zero(), G = Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> twice = Eigen::Matrix<double, 3, 2>::Zero();
};

// The square of the force across the hole.
double Across(const ToolUse& use) {
  constexpr double kG = units::kStandardGravity;
  return std::max(0.0, kG * kG - use.axial_force * use.axial_force);
}

// A sensor that reads e q more, q a product of two components of the force in its own axes.
void AddSquare(const Vector3d& e, const Matrix3d& R_ST, int product, const ToolUse& use,
               bool into_G, GroupError& error) {
  constexpr std::array kFirst{0, 1, 2, 0, 1, 2}, kSecond{0, 1, 2, 1, 2, 0};
  const auto place = static_cast<std::size_t>(product);
  const Matrix3d pair = R_ST.row(kFirst[place]).transpose() * R_ST.row(kSecond[place]);
  const Matrix3d Q = (pair + pair.transpose()) / 2;
  const double z = use.axial_force, square = Across(use);
  error.b += e * (Q(2, 2) * z * z + (Q(0, 0) + Q(1, 1)) * square / 2);
  Matrix3d& linear = into_G ? error.G : error.A;
  linear.leftCols<2>() += 2 * z * e * Q.row(2).head<2>();
  error.twice += square * e * Eigen::RowVector2d((Q(0, 0) - Q(1, 1)) / 2, Q(0, 1));
}

GroupError ErrorOf(const CalibrationMember& member, const GroupAt& at, const ToolUse& use) {
  GroupError error;
  const Vector3d e = -at.from_units.col(member.channel);
  const double power = std::pow(at.tau, member.power);
  switch (member.kind) {
    case Kind::kBias:
      error.b = power * e;
      break;
    case Kind::kSensitivity:
      error.A = power * e * at.R_ST.row(member.column);
      break;
    case Kind::kForce:
      error.G = power * e * at.R_ST.row(member.column);
      break;
    case Kind::kSecondOrder:
      if (!member.is_gyro) AddSquare(e, at.R_ST, member.column, use, false, error);
      break;
    case Kind::kForceSquare:
      AddSquare(e, at.R_ST, member.column, use, true, error);
      break;
    case Kind::kHeating:
      error.b = use.heating * e;
      break;
  }
  return error;
}

ErrorVector OfGyros(const GroupError& g, const ToolUse& use) {
  ErrorVector error = ErrorVector::Zero();
  const Vector3d b = g.b + use.axial_force * g.G.col(2);
  error[kGyroBiasX] = b.x();
  error[kGyroBiasY] = b.y();
  error[kGyroBiasZ] = b.z();
  error[kMassUnbalance] = (g.G(0, 0) + g.G(1, 1)) / 2;
  error[kQuadrature] = (g.G(0, 1) - g.G(1, 0)) / 2;
  error[kGyroScaleX] = g.A(0, 0);
  error[kGyroScaleY] = g.A(1, 1);
  error[kGyroScaleZ] = g.A(2, 2);
  error[kMisalignmentX] = g.A(0, 2);
  error[kMisalignmentY] = g.A(1, 2);
  error[kToolfaceOffset] = (g.A(1, 0) - g.A(0, 1)) / 2;
  return error;
}

ErrorVector OfAccelerometers(const GroupError& g) {
  ErrorVector error = ErrorVector::Zero();
  error.segment<3>(kAccelBiasX) = g.b;
  error.segment<3>(kAccelScaleX) = g.A.diagonal();
  error[kAccelMisalignmentX] = g.A(0, 2);
  error[kAccelMisalignmentY] = g.A(1, 2);
  error[kAccelShear] = (g.A(0, 1) + g.A(1, 0)) / 2;
  error[kAccelMisalignmentZX] = g.A(2, 0);
  error[kAccelMisalignmentZY] = g.A(2, 1);
  error[kToolfaceOffset] = (g.A(0, 1) - g.A(1, 0)) / 2;
  return error;
}

// What no constant stands for, by its amplitudes: of the squares of the force of gyros and of
// accelerometers, which go by twice the toolface, x, y, z of its cosine and then of its sine; of
// the gyros' force terms but mass unbalance and quadrature, which go by the toolface, the same.
constexpr int kVarying = 18;
using VaryingVector = Eigen::Matrix<double, kVarying, 1>;

VaryingVector VaryingOf(const GroupError& g, bool is_gyro, const ToolUse& use) {
  VaryingVector varying = VaryingVector::Zero();
  varying.segment<6>(is_gyro ? 0 : 6) = g.twice.reshaped();
  if (!is_gyro) return varying;
  const double s = (g.G(0, 0) - g.G(1, 1)) / 2, t = (g.G(0, 1) + g.G(1, 0)) / 2;
  varying.segment<6>(12) << s, t, g.G(2, 0), -t, s, -g.G(2, 1);
  varying.segment<6>(12) *= std::sqrt(Across(use));
  return varying;
}

struct Effects {
  Eigen::MatrixXd errors;   // kErrorSources rows
  Eigen::MatrixXd varying;  // kVarying rows
};

Effects EffectsOf(const ToolCalibration& tool, const std::vector<std::string>& members,
                  const ToolUse& use) {
  const GroupAt gyro = At(tool.gyro, use.temperature), accel = At(tool.accel, use.temperature);
  const auto n = static_cast<Eigen::Index>(members.size());
  Effects effects{Eigen::MatrixXd(kErrorSources, n), Eigen::MatrixXd(kVarying, n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    const CalibrationMember member = MemberOf(members[static_cast<std::size_t>(k)]);
    const GroupError error = ErrorOf(member, member.is_gyro ? gyro : accel, use);
    effects.errors.col(k) = member.is_gyro ? OfGyros(error, use) : OfAccelerometers(error);
    effects.varying.col(k) = VaryingOf(error, member.is_gyro, use);
  }
  return effects;
}

// Their mean squares, with the biases.
void AddVarying(const Eigen::MatrixXd& varying, const Eigen::MatrixXd& cov, double share,
                ErrorMatrix& sum) {
  constexpr std::array kBiases{kGyroBiasX,  kGyroBiasY,  kGyroBiasZ,
                               kAccelBiasX, kAccelBiasY, kAccelBiasZ};
  const VaryingVector variance = (varying * cov).cwiseProduct(varying).rowwise().sum();
  for (int k = 0; k < kVarying; ++k) {
    const auto bias = static_cast<std::size_t>(k % 3 + (k / 6 == 1 ? 3 : 0));
    sum(kBiases[bias], kBiases[bias]) += share * variance[k] / 2;
  }
}

}  // namespace

Eigen::MatrixXd ErrorEffects(const ToolCalibration& tool, const std::vector<std::string>& members,
                             std::span<const ToolUse> uses) {
  Eigen::MatrixXd mean =
      Eigen::MatrixXd::Zero(kErrorSources, static_cast<Eigen::Index>(members.size()));
  for (const ToolUse& use : uses) mean += use.share * EffectsOf(tool, members, use).errors;
  return mean;
}

std::optional<ErrorMatrix> ErrorsInUse(const ToolCalibration& tool, std::span<const ToolUse> uses) {
  if (uses.empty() || !(HasMembers(tool.gyro) || HasMembers(tool.accel))) return std::nullopt;
  ErrorMatrix sum = ErrorMatrix::Zero();
  for (const SensorGroup* group : {&tool.gyro, &tool.accel}) {
    if (!HasMembers(*group)) continue;
    const ParameterCovariance& known = *group->covariance;
    for (const ToolUse& use : uses) {
      const Effects effects = EffectsOf(tool, known.names, use);
      sum += use.share * effects.errors * known.cov * effects.errors.transpose();
      AddVarying(effects.varying, known.cov, use.share, sum);
    }
  }
  return sum;
}

}  // namespace wellgyro
