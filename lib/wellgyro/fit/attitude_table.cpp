#include <cmath>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/fit/attitude_table_internal.h"
#include "wellgyro/fit/bench_checks_internal.h"

namespace wellgyro {
namespace {

std::optional<std::vector<int>> FindAll(const BenchTable& data,
                                        const std::vector<std::string>& names) {
  std::vector<int> places;
  for (const std::string& name : names) {
    const auto place = data.Find(name);
    if (!place) return std::nullopt;
    places.push_back(*place);
  }
  return places;
}

std::optional<Fault> ReadAngles(const BenchTable& data, bool needed, AttitudeTable& table) {
  auto places = FindAll(data, {"inc", "az", "tf"});
  if (!places) places = FindAll(data, {"inc_true", "az_true", "tf_true"});
  if (!places) {
    if (!needed) return std::nullopt;
    return FindColumns(data, {"inc", "az", "tf"}).fault();
  }
  if (auto fault = RadiansForDegrees(data, *places)) return fault;
  table.has_attitude = true;
  const auto column = [&](std::size_t i) -> Eigen::VectorXd {
    return data.values.col((*places)[i]) * (kPi / 180);
  };
  table.inclination = column(0);
  table.azimuth = column(1);
  table.toolface = column(2);
  return std::nullopt;
}

std::optional<Fault> ReadSensors(const BenchTable& data, const AttitudeNeeds& needs,
                                 AttitudeTable& table) {
  for (const char* kind : {"G", "a", "f", "v"}) {
    const std::string k(kind);
    const std::vector<std::string> names = {k + "x", k + "y", k + "z"};
    const auto places = FindAll(data, names);
    if (!places) continue;
    // In a table with attitudes az is the azimuth.
    if (k == "a" && data.Find("az") && data.Find("inc")) continue;
    table.accel = data.values(Eigen::all, *places);
    table.accel_channels = names;
    table.gravity_signed = k == "G" || k == "a";
    break;
  }
  for (const char* kind : {"M", "m"}) {
    const std::string k(kind);
    const std::vector<std::string> names = {k + "x", k + "y", k + "z"};
    const auto places = FindAll(data, names);
    if (!places) continue;
    table.mag = data.values(Eigen::all, *places);
    table.mag_channels = names;
    break;
  }
  if (needs.accel && table.accel.rows() == 0) {
    return BenchFault(data,
                      "the table has no accelerometers: columns Gx, Gy, Gz or ax, ay, az "
                      "(gravity-signed), or fx, fy, fz or vx, vy, vz (specific force)",
                      1, FaultCode::kForeign);
  }
  if (needs.mag && table.mag.rows() == 0) {
    return BenchFault(data, "the table has no magnetometers: columns Mx, My, Mz or mx, my, mz", 1,
                      FaultCode::kForeign);
  }
  return std::nullopt;
}

}  // namespace

Eigen::Vector3d AttitudeTable::IdealAccel(int i, const BenchReference& reference) const {
  const Eigen::Matrix3d R = BenchFromLevel(reference.axes, inclination[i], azimuth[i], toolface[i]);
  return (gravity_signed ? reference.gravity : -reference.gravity) * R.col(2);
}

Eigen::Vector3d AttitudeTable::IdealMag(int i, const BenchReference& reference) const {
  const Eigen::Matrix3d R = BenchFromLevel(reference.axes, inclination[i], azimuth[i], toolface[i]);
  const double level = *reference.field * std::cos(*reference.dip);
  return R * Eigen::Vector3d(level * std::cos(reference.declination),
                             level * std::sin(reference.declination),
                             *reference.field * std::sin(*reference.dip));
}

std::vector<int> ColumnsOf(const BenchTable& data, const std::vector<std::string>& channels) {
  return *FindAll(data, channels);
}

std::optional<Fault> BadReadings(const BenchTable& data, const AttitudeTable& table) {
  if (auto fault = Repeated(data)) return fault;
  std::vector<std::string> used = table.accel_channels;
  used.insert(used.end(), table.mag_channels.begin(), table.mag_channels.end());
  if (auto fault = Frozen(data, ColumnsOf(data, used))) return fault;
  // Sequences of whole circles end where they began: the trigonometric method's tables of readings
  // without noise repeat there.
  if (data.Find("seq")) return std::nullopt;
  return Copied(data, ColumnsOf(data, used));
}

Result<AttitudeTable> ReadAttitudeTable(const BenchTable& data, const AttitudeNeeds& needs) {
  AttitudeTable table;
  table.lines = data.lines;
  if (auto fault = ReadAngles(data, needs.attitude, table)) return *std::move(fault);
  if (auto fault = ReadSensors(data, needs, table)) return *std::move(fault);
  return table;
}

}  // namespace wellgyro
