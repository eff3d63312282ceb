#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/gyro_readings_internal.h"

namespace wellgyro {
namespace {

std::vector<std::string> NamesOf(const std::vector<GyroChannel>& channels) {
  std::vector<std::string> names;
  names.reserve(channels.size());
  for (const GyroChannel& channel : channels) names.push_back(channel.name);
  return names;
}

std::optional<Fault> FindChannels(const BenchTable& data, const std::vector<GyroChannel>& channels,
                                  std::vector<int>* places) {
  auto found = FindColumns(data, NamesOf(channels));
  if (!found) return found.fault();
  *places = *std::move(found);
  if (auto fault = Repeated(data)) return fault;
  if (auto fault = Frozen(data, *places)) return fault;
  return Copied(data, *places);
}

// The table's fx, fy, fz against its attitudes.
std::optional<Fault> TakeForces(const BenchTable& data, GyroReadings& readings) {
  const auto fx = data.Find("fx"), fy = data.Find("fy"), fz = data.Find("fz");
  if (!fx || !fy || !fz) return std::nullopt;
  if (auto fault = MixedUnits(data, {*fx, *fy, *fz}, 1, "the length of (fx, fy, fz)", "g")) {
    return fault;
  }
  std::vector<int> wrong;
  for (int i = 0; i < data.rows(); ++i) {
    const Eigen::Vector3d f(data.values(i, *fx), data.values(i, *fy), data.values(i, *fz));
    const double off = (f - readings.f.row(i).transpose()).norm();
    readings.f_off += off * off / data.rows();
    if (off > 0.05) {
      wrong.push_back(data.lines[static_cast<std::size_t>(i)]);
    }
    // What is at right angles is so to the last digit: rounding shall not pass for a signal.
    readings.f.row(i) = (f.array().abs() < 1e-12).select(0, f).transpose();
  }
  readings.f_off = std::sqrt(readings.f_off);
  if (wrong.empty()) return std::nullopt;
  return BenchFault(data,
                    fmt::format("{}: fx, fy, fz do not fit inc and tf: up and down or axes are "
                                "swapped, or the bench's axes are others (--bench-axes)",
                                LinesText(wrong)),
                    wrong.front(), FaultCode::kConflict);
}

std::optional<Fault> ReadRest(const BenchTable& data, const BenchReference& reference,
                              GyroReadings& readings) {
  const auto angles = FindColumns(data, {"inc", "az", "tf"});
  if (!angles) return angles.fault();
  if (auto fault = RadiansForDegrees(data, *angles)) return fault;
  std::vector<int> places;
  if (auto fault = FindChannels(data, readings.channels, &places)) return fault;
  const double level = kBenchEarthDegPerHour * std::cos(*reference.latitude);
  const double down = -kBenchEarthDegPerHour * std::sin(*reference.latitude);
  for (int i = 0; i < data.rows(); ++i) {
    const auto angle = [&](std::size_t k) { return FromDegrees(data.values(i, (*angles)[k])); };
    const Eigen::Matrix3d R = BenchFromLevel(reference.axes, angle(0), angle(1), angle(2));
    readings.w.row(i) = (R * Eigen::Vector3d(level, 0, down)).transpose();
    readings.w_level.row(i) = (R * Eigen::Vector3d(level, 0, 0)).transpose();
    // Turning the fixture clockwise by a small angle: north lies by it to the left.
    readings.w_north.row(i) = (R * Eigen::Vector3d(0, -level, 0)).transpose();
    readings.w_by_latitude.row(i) = (R * Eigen::Vector3d(down, 0, -level)).transpose();
    readings.f.row(i) = -R.col(2).transpose();
    readings.m.row(i) = data.values(i, places);
  }
  return TakeForces(data, readings);
}

std::optional<Fault> ReadTable(const BenchTable& data, const BenchReference& reference, int first,
                               GyroReadings& readings) {
  const auto found = FindColumns(data, {"axis", "rate_deg_s"});
  if (!found) return found.fault();
  std::vector<int> places;
  if (auto fault = FindChannels(data, readings.channels, &places)) return fault;
  // Over whole turns the level part of the Earth's rate is nothing; the axis points up.
  const double up = kBenchEarthDegPerHour * std::sin(*reference.latitude);
  const double up_by_latitude = kBenchEarthDegPerHour * std::cos(*reference.latitude);
  for (int i = 0; i < data.rows(); ++i) {
    const double axis = data.values(i, (*found)[0]);
    if (axis != 0 && axis != 1 && axis != 2) {
      return BenchFault(data, "column axis must be x, y or z",
                        data.lines[static_cast<std::size_t>(i)]);
    }
    const Eigen::Vector3d n = Eigen::Vector3d::Unit(static_cast<int>(axis));
    readings.w.row(first + i) = (data.values(i, (*found)[1]) * units::kHour + up) * n.transpose();
    readings.w_by_latitude.row(first + i) = up_by_latitude * n.transpose();
    readings.f.row(first + i) = n.transpose();
    readings.m.row(first + i) = data.values(i, places);
  }
  return std::nullopt;
}

}  // namespace

Result<std::vector<GyroChannel>> GyroChannelsOf(const BenchTable& data) {
  std::vector<GyroChannel> channels;
  for (const std::string& column : data.columns) {
    if (column.rfind("m_", 0) != 0) continue;
    const std::size_t axis = column.size() > 2 ? std::string("xyz").find(column[2]) : 9;
    if (axis > 2 || column.size() > 4) {
      return BenchFault(data,
                        fmt::format("column {} names no channel, as m_x1: its input axis, and its "
                                    "rotor where two channels share one",
                                    column),
                        1, FaultCode::kForeign);
    }
    const int rotor = column.size() == 4 ? column[3] - '0' : -1;
    channels.push_back({column, static_cast<int>(axis), rotor});
  }
  if (channels.size() < 2 || channels.size() > 4) {
    return BenchFault(data,
                      fmt::format("the table has {} gyro channels, columns m_x1, m_y1 ...: two to "
                                  "four are needed",
                                  channels.size()),
                      1, FaultCode::kForeign);
  }
  return channels;
}

std::vector<Rotor> RotorsOf(const std::vector<GyroChannel>& channels) {
  std::map<int, std::vector<int>> of;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].rotor >= 0) of[channels[i].rotor].push_back(static_cast<int>(i));
  }
  std::vector<Rotor> rotors;
  for (auto& [rotor, pair] : of) {
    if (pair.size() != 2) continue;
    const auto axis = [&](int channel) { return channels[static_cast<std::size_t>(channel)].axis; };
    if (axis(pair[0]) > axis(pair[1])) std::swap(pair[0], pair[1]);
    if (axis(pair[0]) == axis(pair[1])) continue;
    rotors.push_back({pair[0], pair[1], 3 - axis(pair[0]) - axis(pair[1])});
  }
  return rotors;
}

Result<GyroReadings> ReadGyros(const BenchTable& rest, const BenchTable& table,
                               const BenchReference& reference) {
  if (!reference.latitude) throw std::invalid_argument("gyros need the latitude");
  const auto channels = GyroChannelsOf(rest.rows() > 0 ? rest : table);
  if (!channels) return channels.fault();
  GyroReadings readings;
  readings.channels = *channels;
  readings.joined = rest.rows() > 0 && table.rows() > 0;
  readings.rotors = RotorsOf(*channels);
  readings.lines = rest.lines;
  readings.lines.insert(readings.lines.end(), table.lines.begin(), table.lines.end());
  readings.on_table.assign(readings.lines.size(), 0);
  std::fill(readings.on_table.begin() + rest.rows(), readings.on_table.end(), char{1});
  readings.w = readings.w_level = readings.w_north = readings.w_by_latitude = readings.f =
      Eigen::MatrixX3d::Zero(readings.rows(), 3);
  readings.m.resize(readings.rows(), static_cast<Eigen::Index>(channels->size()));
  if (rest.rows() > 0) {
    if (auto fault = ReadRest(rest, reference, readings)) return *fault;
  }
  if (table.rows() > 0) {
    if (auto fault = ReadTable(table, reference, rest.rows(), readings)) return *fault;
  }
  return readings;
}

}  // namespace wellgyro
