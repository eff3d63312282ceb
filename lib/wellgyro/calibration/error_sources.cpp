#include "wellgyro/calibration/error_sources.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/group_at_internal.h"
#include "wellgyro/calibration/members.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

using Kind = CalibrationMember::Kind;

// Where the sources stand.
constexpr int kGyroBias = 0, kGyroRate = 3, kGyroForce = 12, kUnbalanceMean = 21,
              kQuadratureMean = 22;
constexpr int kAccelBias = 23, kAccelForce = 26, kSources = 35;

std::vector<std::string> SourceNames() {
  constexpr std::array kAxes{'x', 'y', 'z'};
  std::vector<std::string> names;
  const auto vector = [&](const char* name) {
    for (const char a : kAxes) names.push_back(fmt::format("{}_{}", name, a));
  };
  const auto matrix = [&](const std::string& on, const std::string& beside) {
    for (const char a : kAxes) {
      for (const char b : kAxes) {
        names.push_back(a == b && !on.empty() ? fmt::format("{}_{}", on, a)
                                              : fmt::format("{}_{}{}", beside, a, b));
      }
    }
  };
  vector("gyro_bias");
  matrix("gyro_scale", "gyro_misalignment");
  matrix("", "gyro_force");
  names.emplace_back("mass_unbalance");
  names.emplace_back("quadrature");
  vector("accel_bias");
  matrix("accel_scale", "accel_misalignment");
  return names;
}

void Put(Eigen::VectorXd& column, int first, const Eigen::Matrix3d& by) {
  for (int i = 0; i < 3; ++i) column.segment<3>(first + 3 * i) += by.row(i).transpose();
}

// What one more of a member does to the samples.
Eigen::VectorXd EffectOf(const CalibrationMember& member, const GroupAt& at) {
  Eigen::VectorXd column = Eigen::VectorXd::Zero(kSources);
  const int bias = member.is_gyro ? kGyroBias : kAccelBias;
  const double power = std::pow(at.tau, member.power);
  const Eigen::Vector3d e = -at.from_units.col(member.channel);
  constexpr double kG2 = units::kStandardGravity * units::kStandardGravity;
  switch (member.kind) {
    case Kind::kBias:
      column.segment<3>(bias) = power * e;
      break;
    case Kind::kSensitivity:
      Put(column, member.is_gyro ? kGyroRate : kAccelForce, power * e * at.R_ST.row(member.column));
      break;
    case Kind::kForce:
      Put(column, kGyroForce, power * e * at.R_ST.row(member.column));
      break;
    case Kind::kSecondOrder:
      if (!member.is_gyro && member.column < 3) column.segment<3>(bias) = kG2 / 3 * e;
      break;
    case Kind::kForceSquare:
      if (member.column < 3) column.segment<3>(bias) = kG2 / 3 * e;
      break;
    case Kind::kHeating:
      break;
  }
  // x: G_xx f_x + G_xy f_y, y: G_yx f_x + G_yy f_y.
  column[kUnbalanceMean] = (column[kGyroForce] + column[kGyroForce + 4]) / 2;
  column[kQuadratureMean] = (column[kGyroForce + 1] - column[kGyroForce + 3]) / 2;
  return column;
}

double Sigma(const CalibrationSources& sources, int at) {
  return std::sqrt(std::max(0.0, sources.cov(at, at)));
}

// Largest over places of a 3 x 3 block, on its diagonal or beside.
double LargestOf(const CalibrationSources& sources, int first, bool diagonal, int rows) {
  double largest = 0;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < 3; ++j) {
      if ((i == j) == diagonal) largest = std::max(largest, Sigma(sources, first + 3 * i + j));
    }
  }
  return largest;
}

// Whether the covariance of members has any of a group, "gyro." or "accel.".
bool KnowsMembers(const ToolCalibration& tool, std::string_view prefix) {
  for (const SensorGroup* group : {&tool.gyro, &tool.accel}) {
    if (!HasMembers(*group)) continue;
    const auto& names = group->covariance->names;
    if (std::any_of(names.begin(), names.end(),
                    [&](const std::string& name) { return name.starts_with(prefix); })) {
      return true;
    }
  }
  return false;
}

// Of what `effects_of` says the members do.
template <class Effects>
CalibrationSources SumOver(const ToolCalibration& tool, const Effects& effects_of) {
  CalibrationSources sources{SourceNames(), Eigen::MatrixXd::Zero(kSources, kSources)};
  for (const SensorGroup* group : {&tool.gyro, &tool.accel}) {
    if (!HasMembers(*group)) continue;
    const ParameterCovariance& known = *group->covariance;
    const Eigen::MatrixXd J = effects_of(known.names);
    sources.cov += J * known.cov * J.transpose();
  }
  return sources;
}

void Raise(double& sigma, double to) { sigma = std::max(sigma, to); }

void TakeGyroErrors(const CalibrationSources& sources, int across, ErrorPriors& errors) {
  for (int i = 0; i < 3; ++i) Raise(errors.gyro_bias_sigma, Sigma(sources, kGyroBias + i));
  Raise(errors.gyro_scale_sigma, LargestOf(sources, kGyroRate, true, across));
  Raise(errors.gyro_misalignment_sigma, LargestOf(sources, kGyroRate, false, across));
  Raise(errors.mass_unbalance_sigma, Sigma(sources, kUnbalanceMean));
  Raise(errors.quadrature_sigma, Sigma(sources, kQuadratureMean));
}

void TakeAccelErrors(const CalibrationSources& sources, ErrorPriors& errors) {
  for (int i = 0; i < 3; ++i) Raise(errors.accel_bias_sigma, Sigma(sources, kAccelBias + i));
  Raise(errors.accel_scale_sigma, LargestOf(sources, kAccelForce, true, 3));
  Raise(errors.accel_misalignment_sigma, LargestOf(sources, kAccelForce, false, 3));
}

}  // namespace

GroupAt At(const SensorGroup& group, double temperature) {
  GroupAt at;
  const double held = std::clamp(temperature, group.min, group.max);
  at.tau = group.thermometer < 0 ? 0 : (held - group.reference) / group.half_range;
  at.R_ST = group.R_TS.transpose();
  SensorGroup::Rows S = group.sensitivity.back();
  for (std::size_t n = group.sensitivity.size() - 1; n-- > 0;) {
    S = S * at.tau + group.sensitivity[n];
  }
  const SensorGroup::Rows S_T = S * at.R_ST;
  if (group.n_channels == 2) {
    at.from_units.topLeftCorner<2, 2>() = Eigen::Matrix2d(S_T.topLeftCorner<2, 2>()).inverse();
  } else if (group.n_channels == 3) {
    at.from_units.leftCols<3>() = Eigen::Matrix3d(S_T.topRows<3>()).inverse();
  } else if (group.n_channels == 4) {
    at.from_units = LeftInverse(S_T);
  }
  return at;
}

bool HasMembers(const SensorGroup& group) {
  return group.covariance && !group.covariance->names.empty() &&
         (group.covariance->names.front().rfind("gyro.", 0) == 0 ||
          group.covariance->names.front().rfind("accel.", 0) == 0);
}

Eigen::Index CalibrationSources::At(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw std::invalid_argument(fmt::format("no error of a calibration is called {}", name));
  }
  return found - names.begin();
}

Eigen::MatrixXd SourceEffects(const ToolCalibration& tool, const std::vector<std::string>& members,
                              double temperature) {
  const GroupAt gyro = At(tool.gyro, temperature), accel = At(tool.accel, temperature);
  Eigen::MatrixXd J(kSources, static_cast<Eigen::Index>(members.size()));
  for (Eigen::Index k = 0; k < J.cols(); ++k) {
    const CalibrationMember member = MemberOf(members[static_cast<std::size_t>(k)]);
    J.col(k) = EffectOf(member, member.is_gyro ? gyro : accel);
  }
  return J;
}

CalibrationSources SourcesOf(const ToolCalibration& tool, double temperature) {
  return SumOver(tool, [&](const std::vector<std::string>& members) {
    return SourceEffects(tool, members, temperature);
  });
}

CovarianceParts SourcesByParts(const ToolCalibration& tool, const std::vector<std::string>& members,
                               const CovarianceParts& parts, double temperature) {
  CovarianceParts of_sources = Propagated(parts, SourceEffects(tool, members, temperature));
  for (const SensorGroup* group : {&tool.gyro, &tool.accel}) {
    if (!HasMembers(*group) || group->covariance->names == members) continue;
    const ParameterCovariance& known = *group->covariance;
    const Eigen::MatrixXd J = SourceEffects(tool, known.names, temperature);
    of_sources.Add("earlier calibration", J * known.cov * J.transpose());
  }
  return of_sources;
}

CalibrationSources ChangeOfSources(const ToolCalibration& tool, double from, double to) {
  return SumOver(tool, [&](const std::vector<std::string>& members) -> Eigen::MatrixXd {
    return SourceEffects(tool, members, to) - SourceEffects(tool, members, from);
  });
}

Eigen::Vector2d AxialCoupling(const SensorGroup& gyro) {
  if (gyro.n_channels != 2) return Eigen::Vector2d::Zero();
  const SensorGroup::Rows S_T = gyro.sensitivity[0] * gyro.R_TS.transpose();
  const Eigen::Matrix2d across = S_T.topLeftCorner<2, 2>();
  return across.inverse() * S_T.col(2).head<2>();
}

ErrorPriors ErrorsLeft(const ToolCalibration& tool, ErrorPriors errors) {
  const bool gyro = KnowsMembers(tool, "gyro."), accel = KnowsMembers(tool, "accel.");
  if (gyro) {
    errors.gyro_bias_sigma = errors.gyro_scale_sigma = errors.gyro_misalignment_sigma = 0;
    errors.mass_unbalance_sigma = errors.quadrature_sigma = 0;
  }
  if (accel) {
    errors.accel_bias_sigma = errors.accel_scale_sigma = errors.accel_misalignment_sigma = 0;
  }
  const SensorGroup& group = gyro ? tool.gyro : tool.accel;
  const bool varies = group.thermometer >= 0;
  // Of the calibrated range, at whose temperatures the largest sigma is sought: a variance of terms
  // up to the third power has five turning points at most, fewer than the nine places looked at.
  constexpr int kSteps = 8;
  for (int step = 0; step <= (varies ? kSteps : 0); ++step) {
    const double T = varies ? group.min + (group.max - group.min) * step / kSteps : 0;
    const CalibrationSources sources = SourcesOf(tool, T);
    if (gyro) TakeGyroErrors(sources, tool.gyro.n_channels == 2 ? 2 : 3, errors);
    if (accel) TakeAccelErrors(sources, errors);
  }
  return errors;
}

}  // namespace wellgyro
