#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "wellgyro/calibration/apply.h"
#include "wellgyro/calibration/members.h"
#include "wellgyro/math/linear_algebra.h"

namespace wellgyro {
namespace {

using Complaint = std::optional<std::string>;

template <class T>
bool Finite(const std::array<T, SensorGroup::kPowers>& powers) {
  for (const T& value : powers) {
    if (!value.allFinite()) return false;
  }
  return true;
}

Complaint ChannelComplaint(const SensorGroup& group, const std::string& name, int least) {
  const int n = group.n_channels;
  if (n < least || n > SensorGroup::kChannels) {
    return fmt::format("{}: {} channels, it takes {} to {}", name, n, least,
                       SensorGroup::kChannels);
  }
  for (int c = 0; c < n; ++c) {
    const int place = group.channel[static_cast<std::size_t>(c)];
    if (place < 0 || place >= RawSample::kChannelsMax) {
      return fmt::format("{}: channel {} is outside 0 to {}", name, place,
                         RawSample::kChannelsMax - 1);
    }
    for (int other = 0; other < c; ++other) {
      if (group.channel[static_cast<std::size_t>(other)] == place) {
        return fmt::format("{}: channel {} is named twice", name, place);
      }
    }
    if (!std::isfinite(group.unit_per_count[c]) || group.unit_per_count[c] == 0) {
      return fmt::format("{}: unit_per_count of channel {} is {}", name, place,
                         group.unit_per_count[c]);
    }
  }
  return std::nullopt;
}

// Of members of the tool model, names that are none and channels that it has not.
Complaint CovarianceComplaint(const ToolCalibration& tool, const SensorGroup& group,
                              const std::string& name) {
  if (!group.covariance) return std::nullopt;
  const ParameterCovariance& known = *group.covariance;
  const auto n = static_cast<Eigen::Index>(known.names.size());
  if (known.cov.rows() != n || known.cov.cols() != n || !known.cov.allFinite()) {
    return fmt::format("{}: the covariance is not that of its {} parameters", name, n);
  }
  Eigen::Index at = 0;
  if (n > 0 && known.cov.diagonal().minCoeff(&at) < 0) {
    return fmt::format("{}: the variance of {} is negative", name,
                       known.names[static_cast<std::size_t>(at)]);
  }
  for (const std::string& parameter : known.names) {
    if (parameter.rfind("gyro.", 0) != 0 && parameter.rfind("accel.", 0) != 0) continue;
    try {
      const CalibrationMember member = MemberOf(parameter);
      if (member.channel < (member.is_gyro ? tool.gyro : tool.accel).n_channels) continue;
      return fmt::format("{}: there is no channel of {}", name, parameter);
    } catch (const std::invalid_argument& error) {
      return fmt::format("{}: {}", name, error.what());
    }
  }
  return std::nullopt;
}

Complaint TemperatureComplaint(const SensorGroup& group, const std::string& name,
                               std::size_t thermometers) {
  if (group.thermometer < -1 || group.thermometer >= static_cast<int>(thermometers)) {
    return fmt::format("{}: there is no thermometer {}", name, group.thermometer);
  }
  if (!(group.heating_lag > 0)) return fmt::format("{}: heating lag {} s", name, group.heating_lag);
  const bool varies = [&] {
    for (std::size_t n = 1; n < SensorGroup::kPowers; ++n) {
      if (!group.bias[n].isZero(0) || !group.sensitivity[n].isZero(0) ||
          !group.g_dependence[n].isZero(0)) {
        return true;
      }
    }
    return !group.heating.isZero(0);
  }();
  if (group.thermometer < 0) {
    return varies ? Complaint(name + ": terms in temperature, but no thermometer") : std::nullopt;
  }
  if (!std::isfinite(group.reference) || !(group.half_range > 0) || !(group.min <= group.max)) {
    return fmt::format("{}: temperature reference {}, half range {}, from {} to {} degC", name,
                       group.reference, group.half_range, group.min, group.max);
  }
  return std::nullopt;
}

// Smallest singular value against the largest, of what is solved for.
double Condition(const SensorGroup& group, double tau) {
  SensorGroup::Rows S = SensorGroup::Rows::Zero();
  for (std::size_t n = SensorGroup::kPowers; n-- > 0;) S = S * tau + group.sensitivity[n];
  S = S * group.R_TS.transpose();
  const Eigen::MatrixXd used = group.n_channels == 2 ? Eigen::MatrixXd(S.topLeftCorner<2, 2>())
                                                     : Eigen::MatrixXd(S.topRows(group.n_channels));
  const Eigen::VectorXd values = SingularValuesOf(used).values;
  return values[0] > 0 ? values[values.size() - 1] / values[0] : 0;
}

Complaint GroupComplaint(const SensorGroup& group, const std::string& name, int least,
                         std::size_t thermometers) {
  if (group.n_channels == 0) return std::nullopt;
  if (auto complaint = ChannelComplaint(group, name, least)) return complaint;
  if (!Finite(group.bias) || !Finite(group.sensitivity) || !Finite(group.g_dependence) ||
      !group.second_order.allFinite() || !group.g_squared.allFinite() ||
      !group.heating.allFinite() || !group.R_TS.allFinite()) {
    return name + ": a coefficient is not a number";
  }
  if (!(group.R_TS * group.R_TS.transpose()).isIdentity(1e-9)) {
    return name + ": the axes are not at right angles";
  }
  if (auto complaint = TemperatureComplaint(group, name, thermometers)) return complaint;
  const double lowest =
      group.thermometer < 0 ? 0 : (group.min - group.reference) / group.half_range;
  const double highest =
      group.thermometer < 0 ? 0 : (group.max - group.reference) / group.half_range;
  for (const double tau : {0.0, lowest, highest}) {
    if (!(Condition(group, tau) > 1e-3)) {
      return fmt::format("{}: the sensitivities do not separate the axes{}", name,
                         tau == 0 ? "" : " at an end of the temperature range");
    }
  }
  return std::nullopt;
}

}  // namespace

Complaint FindComplaint(const ToolCalibration& tool) {
  if (tool.gyro.n_channels == 0 && tool.accel.n_channels == 0 && tool.mag.n_channels == 0) {
    return "the tool model has no sensors";
  }
  for (const ThermometerCalibration& t : tool.thermometers) {
    if (t.channel < 0 || t.channel >= RawSample::kTemperaturesMax) {
      return fmt::format("thermometer: channel {} is outside 0 to {}", t.channel,
                         RawSample::kTemperaturesMax - 1);
    }
    if (!std::isfinite(t.offset + t.gain + t.c0 + t.c1 + t.c2 + t.knee) || t.gain == 0 ||
        !std::isfinite(t.min) || !std::isfinite(t.max) || !(t.min < t.max)) {
      return "thermometer: its numbers make no sense";
    }
  }
  const std::size_t thermometers = tool.thermometers.size();
  if (auto complaint = GroupComplaint(tool.gyro, "gyro", 2, thermometers)) return complaint;
  if (auto complaint = GroupComplaint(tool.accel, "accel", 3, thermometers)) return complaint;
  if (auto complaint = GroupComplaint(tool.mag, "mag", 3, thermometers)) return complaint;
  if (auto complaint = CovarianceComplaint(tool, tool.gyro, "gyro")) return complaint;
  if (auto complaint = CovarianceComplaint(tool, tool.accel, "accel")) return complaint;
  const bool feels_force =
      tool.gyro.n_channels > 0 &&
      (!tool.gyro.g_squared.isZero(0) ||
       std::any_of(tool.gyro.g_dependence.begin(), tool.gyro.g_dependence.end(),
                   [](const SensorGroup::Rows& rows) { return !rows.isZero(0); }));
  if (feels_force && tool.accel.n_channels == 0) {
    return "gyro: terms in the specific force, but no accelerometers";
  }
  if (tool.calibrated && tool.expires && *tool.expires <= *tool.calibrated) {
    return "the calibration expires before it was made";
  }
  return std::nullopt;
}

}  // namespace wellgyro
