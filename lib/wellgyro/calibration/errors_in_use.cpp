#include "wellgyro/calibration/errors_in_use.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/group_at_internal.h"
#include "wellgyro/calibration/members.h"
#include "wellgyro/record/products.h"

namespace wellgyro {
namespace {

using Kind = CalibrationMember::Kind;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Errors of one group of sensors: b + A u + K q(u) + G f, and the part of the squares of the force
// that goes by cosine and sine of twice the toolface.
struct GroupError {
  Vector3d b = Vector3d::Zero();
  Matrix3d A = Matrix3d::Zero(), G = Matrix3d::Zero();
  Eigen::Matrix<double, 3, 6> K = Eigen::Matrix<double, 3, 6>::Zero();
  Eigen::Matrix<double, 3, 2> twice = Eigen::Matrix<double, 3, 2>::Zero();
};

// The square of the force across the hole.
double Across(const ToolUse& use) {
  constexpr double kG = units::kStandardGravity;
  return std::max(0.0, kG * kG - use.axial_force * use.axial_force);
}

// u' Q u is a product of two components of u in the sensors' axes, u in T.
Matrix3d ProductInT(const Matrix3d& R_ST, int product) {
  const Matrix3d pair =
      R_ST.row(kFirstFactor[product]).transpose() * R_ST.row(kSecondFactor[product]);
  return (pair + pair.transpose()) / 2;
}

// A gyro that reads e f' Q f more.
void AddForceSquare(const Vector3d& e, const Matrix3d& Q, const ToolUse& use, GroupError& error) {
  const double z = use.axial_force, square = Across(use);
  error.b += e * (Q(2, 2) * z * z + (Q(0, 0) + Q(1, 1)) * square / 2);
  error.G.leftCols<2>() += 2 * z * e * Q.row(2).head<2>();
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
      if (!member.is_gyro) {
        const Matrix3d Q = ProductInT(at.R_ST, member.column);
        error.K.leftCols<3>() = e * Q.diagonal().transpose();
        error.K.rightCols<3>() = e * Eigen::RowVector3d(2 * Q(0, 1), 2 * Q(1, 2), 2 * Q(2, 0));
      }
      break;
    case Kind::kForceSquare:
      AddForceSquare(e, ProductInT(at.R_ST, member.column), use, error);
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
  error[kGyroMisalignmentZX] = g.A(2, 0);
  error[kGyroMisalignmentZY] = g.A(2, 1);
  error[kGyroShear] = (g.A(0, 1) + g.A(1, 0)) / 2;
  error[kUnbalanceDifference] = (g.G(0, 0) - g.G(1, 1)) / 2;
  error[kQuadratureSum] = (g.G(0, 1) + g.G(1, 0)) / 2;
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
  error.tail<kSecondOrderSources>() = g.K.transpose().reshaped();
  return error;
}

// What no constant stands for, by its amplitudes, all of the gyros: of the squares of the force,
// which go by twice the toolface, x, y, z of its cosine and then of its sine; of what a third axis
// feels of the force across, which goes by the toolface, the same.
constexpr int kVarying = 12;
using VaryingVector = Eigen::Matrix<double, kVarying, 1>;

VaryingVector VaryingOf(const GroupError& g, const ToolUse& use) {
  VaryingVector varying;
  varying << g.twice.reshaped(), 0, 0, g.G(2, 0), 0, 0, -g.G(2, 1);
  varying.tail<6>() *= std::sqrt(Across(use));
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
    effects.varying.col(k) = VaryingOf(error, use);
  }
  return effects;
}

// Their mean squares, with the biases.
void AddVarying(const Eigen::MatrixXd& varying, const Eigen::MatrixXd& cov, double share,
                ErrorMatrix& sum) {
  constexpr std::array kBiases{kGyroBiasX, kGyroBiasY, kGyroBiasZ};
  const VaryingVector variance = (varying * cov).cwiseProduct(varying).rowwise().sum();
  for (int k = 0; k < kVarying; ++k) {
    const auto bias = kBiases[static_cast<std::size_t>(k % 3)];
    sum(bias, bias) += share * variance[k] / 2;
  }
}

// Temperatures of `uses` about their mean, the largest difference being one.
struct Warmth {
  double reference = 0, span = 1;
  double square = 0;  // mean; 0: all are alike
  double Of(const ToolUse& use) const { return (use.temperature - reference) / span; }
};

Warmth WarmthOf(std::span<const ToolUse> uses) {
  Warmth warmth;
  double largest = 0;
  for (const ToolUse& use : uses) warmth.reference += use.share * use.temperature;
  for (const ToolUse& use : uses) {
    largest = std::max(largest, std::abs(use.temperature - warmth.reference));
  }
  // Below that lies what thermometers' numbers round.
  constexpr double kLeast = 1e-3;  // [degC]
  if (!(largest > kLeast)) return warmth;
  warmth.span = largest;
  for (const ToolUse& use : uses) warmth.square += use.share * std::pow(warmth.Of(use), 2);
  return warmth;
}

// Of each use the straight line through the effects of all; what is beside it is constant.
void AddMembers(const ToolCalibration& tool, const ParameterCovariance& known,
                std::span<const ToolUse> uses, const Warmth& warmth, ErrorCovariance& sum) {
  std::vector<Effects> effects;
  const auto n = static_cast<Eigen::Index>(known.names.size());
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(kErrorSources, n), slope = mean;
  for (const ToolUse& use : uses) {
    effects.push_back(EffectsOf(tool, known.names, use));
    mean += use.share * effects.back().errors;
    if (warmth.square > 0) {
      slope += use.share * warmth.Of(use) / warmth.square * effects.back().errors;
    }
  }
  for (std::size_t k = 0; k < uses.size(); ++k) {
    const Eigen::MatrixXd constant = effects[k].errors - warmth.Of(uses[k]) * slope;
    sum.constant += uses[k].share * constant * known.cov * constant.transpose();
    AddVarying(effects[k].varying, known.cov, uses[k].share, sum.constant);
  }
  sum.change += slope * known.cov * slope.transpose();
  sum.constant_with_change += mean * known.cov * slope.transpose();
}

}  // namespace

Eigen::MatrixXd ErrorEffects(const ToolCalibration& tool, const std::vector<std::string>& members,
                             std::span<const ToolUse> uses) {
  Eigen::MatrixXd mean =
      Eigen::MatrixXd::Zero(kErrorSources, static_cast<Eigen::Index>(members.size()));
  for (const ToolUse& use : uses) mean += use.share * EffectsOf(tool, members, use).errors;
  return mean;
}

std::optional<ErrorCovariance> ErrorsInUse(const ToolCalibration& tool,
                                           std::span<const ToolUse> uses) {
  if (uses.empty() || !(HasMembers(tool.gyro) || HasMembers(tool.accel))) return std::nullopt;
  const Warmth warmth = WarmthOf(uses);
  ErrorCovariance sum;
  sum.reference = warmth.reference;
  sum.span = warmth.span;
  for (const SensorGroup* group : {&tool.gyro, &tool.accel}) {
    if (HasMembers(*group)) AddMembers(tool, *group->covariance, uses, warmth, sum);
  }
  return sum;
}

}  // namespace wellgyro
