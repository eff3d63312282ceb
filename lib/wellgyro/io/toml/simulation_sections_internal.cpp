#include "wellgyro/io/toml/simulation_sections_internal.h"

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/coefficients_internal.h"
#include "wellgyro/simulate/tool_errors.h"

namespace wellgyro {
namespace {

constexpr double kDeg = units::kDeg;

template <class Vector>
void ReadVector(TomlTable& table, std::string_view key, Vector& value, double unit) {
  const auto numbers = table.FindNumbers(key, kAnyNumber);
  if (!numbers) return;
  if (std::ssize(*numbers) != value.size()) {
    table.Refuse(key, fmt::format("must have {} numbers", value.size()), FaultCode::kSyntax);
  }
  for (Eigen::Index i = 0; i < value.size(); ++i) {
    value[i] = (*numbers)[static_cast<std::size_t>(i)] * unit;
  }
}

void ReadInt32(TomlTable& table, std::string_view key, std::int32_t& value, std::int64_t min) {
  value = static_cast<std::int32_t>(table.FindInteger(key, min, kInt32Most).value_or(value));
}

AngleLaw ReadLaw(TomlTable& well, std::string_view key) {
  AngleLaw law;
  std::optional<TomlTable> table = well.FindTable(key);
  if (!table) return law;
  table->Read("start_deg", law.start, kDeg);
  for (TomlTable& t : table->FindTables("term")) {
    AngleTerm& term = law.terms.emplace_back();
    t.Read("begin_md_m", term.begin_md);
    t.Read("end_md_m", term.end_md);
    t.Read("ramp_m", term.ramp, 1, kNotNegative);
    t.Read("rate_deg_per_30m", term.rate, units::kDegPer30m);
    t.Read("amplitude_deg", term.amplitude, kDeg);
    t.Read("period_m", term.period, 1, kPositive);
    t.Read("phase_deg", term.phase, kDeg);
  }
  return law;
}

// From vertical at the kick-off to `inclination`, then straight on.
AngleLaw BuildAndHold(TomlTable& table, double inclination, double end_md) {
  const auto kick_off = table.FindNumber("kick_off_md_m", kAnyNumber);
  const auto rate = table.FindNumber("build_rate_deg_per_30m", kPositive);
  AngleTerm build;
  build.begin_md = table.Need("kick_off_md_m", kick_off);
  build.rate = table.Need("build_rate_deg_per_30m", rate) * units::kDegPer30m;
  build.ramp = 10;
  // The two ramps take half of themselves each.
  build.end_md = *build.begin_md + inclination / build.rate + build.ramp;
  if (*build.end_md > end_md || *build.end_md < *build.begin_md + 2 * build.ramp) {
    table.Refuse("build_rate_deg_per_30m",
                 fmt::format("the build would end at {} m: not within the well, or shorter than "
                             "its ramps of {} m",
                             *build.end_md, build.ramp));
  }
  AngleLaw law;
  law.terms.push_back(build);
  return law;
}

ToolMode::Mode ReadMode(TomlTable& table, ToolMode::Mode absent) {
  using Mode = ToolMode::Mode;
  return table
      .FindWord<Mode>("mode", {{"unknown", Mode::kUnknown},
                               {"idle", Mode::kIdle},
                               {"moving", Mode::kMoving},
                               {"stationary", Mode::kStationary},
                               {"gyrocompass", Mode::kGyrocompass},
                               {"continuous", Mode::kContinuous}})
      .value_or(absent);
}

RunStop ReadStop(TomlTable& table, double seconds) {
  RunStop stop;
  stop.seconds = seconds;
  for (const double angle :
       table.FindNumbers("index_angles_deg", kAnyNumber).value_or(std::vector<double>())) {
    stop.index_angles.push_back(angle * kDeg);
  }
  table.Read("turn_s", stop.turn_seconds, 1, kPositive);
  table.Read("toolface_deg", stop.toolface, kDeg);
  stop.mode = ReadMode(table, stop.mode);
  return stop;
}

RunMove ReadMove(TomlTable& table, double to_md) {
  RunMove move;
  move.to_md = to_md;
  table.Read("speed_mps", move.speed, 1, kPositive);
  table.Read("ramp_s", move.ramp, 1, kPositive);
  table.Read("roll_rpm", move.roll.rate, kTwoPi / 60);
  table.Read("roll_amplitude_deg", move.roll.amplitude, kDeg);
  table.Read("roll_period_s", move.roll.period, 1, kPositive);
  table.Read("roll_phase_deg", move.roll.phase, kDeg);
  return move;
}

RunStep ReadStep(TomlTable& table) {
  const auto to_md = table.FindNumber("to_md_m", kAnyNumber);
  const auto stop = table.FindNumber("stop_s", kNotNegative);
  if (to_md.has_value() == stop.has_value()) {
    table.Refuse("", "a step has to_md_m, which moves, or stop_s, which waits",
                 FaultCode::kConflict);
  }
  if (stop) return ReadStop(table, *stop);
  return ReadMove(table, *to_md);
}

void ReadActualGyroErrors(TomlTable& table, ToolErrors& e) {
  ReadVector(table, "gyro_bias_deg_per_h", e.gyro_bias, units::kDegPerHour);
  ReadVector(table, "gyro_scale", e.gyro_scale, 1);
  ReadVector(table, "gyro_misalignment_rad", e.gyro_misalignment, 1);
  table.Read("mass_unbalance_deg_per_h_per_g", e.mass_unbalance, units::kDegPerHourPerG);
  table.Read("quadrature_deg_per_h_per_g", e.quadrature, units::kDegPerHourPerG);
  table.Read("flicker", e.flicker);
  table.Read("gyro_full_scale_deg_per_s", e.gyro_full_scale, kDeg, kPositive);
  table.Read("roll_offset_deg", e.roll_offset, kDeg);
  table.Read("time_skew_s", e.time_skew);
}

/// x by y and by z, y by x and by z, z by x and by y.
void ReadMisalignment(TomlTable& table, Eigen::Matrix3d& misalignment) {
  Eigen::Vector<double, 6> given;
  given << misalignment(0, 1), misalignment(0, 2), misalignment(1, 0), misalignment(1, 2),
      misalignment(2, 0), misalignment(2, 1);
  ReadVector(table, "accel_misalignment_rad", given, 1);
  misalignment << 0, given[0], given[1], given[2], 0, given[3], given[4], given[5], 0;
}

void ReadActualOtherErrors(TomlTable& table, ToolErrors& e) {
  ReadVector(table, "accel_bias_mps2", e.accel_bias, 1);
  ReadVector(table, "accel_scale", e.accel_scale, 1);
  ReadMisalignment(table, e.accel_misalignment);
  table.Read("accel_quantization_mps", e.accel_quantization, 1, kNotNegative);
  table.Read("accel_full_scale_mps2", e.accel_full_scale, 1, kPositive);
  ReadVector(table, "accel_lever_arm_m", e.accel_lever_arm_T, 1);
  table.Read("mag_noise_nt", e.mag_noise, units::kNanotesla, kNotNegative);
  table.Read("clock_offset_s", e.clock_offset);
  table.Read("clock_drift", e.clock_drift, 1, {.min = -0.5, .max = 0.5});
  table.Read("utc_jitter_s", e.utc_jitter, 1, kNotNegative);
  table.Read("depth_offset_m", e.depth_offset);
  table.Read("depth_scale", e.depth_scale, 1, {.min = -0.5, .max = 0.5});
  table.Read("depth_noise_m", e.depth_noise, 1, kNotNegative);
  table.Read("depth_resolution_m", e.depth_resolution, 1, kNotNegative);
}

}  // namespace

SimulatedWell ReadSimulatedWell(TomlTable& table) {
  SimulatedWell well;
  if (const auto rows = table.FindRows("table", 3)) {
    for (const std::vector<double>& row : *rows) {
      well.stations.push_back(
          {.md = row[0], .inclination = row[1] * kDeg, .azimuth = row[2] * kDeg});
    }
    return well;
  }
  enum class Name { kVertical, kSlant, kBuildHold, kLaws };
  const Name name =
      table.Need("name", table.FindWord<Name>("name", {{"vertical", Name::kVertical},
                                                       {"slant", Name::kSlant},
                                                       {"build_hold", Name::kBuildHold},
                                                       {"laws", Name::kLaws}}));
  table.Read("begin_md_m", well.begin_md);
  well.end_md = table.Need("end_md_m", table.FindNumber("end_md_m", kAnyNumber));
  if (!(well.end_md > well.begin_md)) table.Refuse("end_md_m", "must lie below begin_md_m");
  if (name == Name::kLaws) {
    well.inclination = ReadLaw(table, "inclination");
    well.azimuth = ReadLaw(table, "azimuth");
  } else if (name != Name::kVertical) {
    const auto inclination = table.FindNumber("inclination_deg", kInclinationDeg);
    table.Read("azimuth_true_deg", well.azimuth.start, kDeg, kAzimuthDeg);
    well.inclination.start = table.Need("inclination_deg", inclination) * kDeg;
    if (name == Name::kBuildHold) {
      well.inclination = BuildAndHold(table, well.inclination.start, well.end_md);
    }
  }
  return well;
}

SimulatedRun ReadSimulatedRun(TomlTable table) {
  SimulatedRun run;
  table.Read("start_md_m", run.start_md);
  table.Read("start_toolface_deg", run.start_toolface, kDeg);
  run.roll_reference =
      table
          .FindWord<RollReference>("roll_reference", {{"north", RollReference::kNorth},
                                                      {"high_side", RollReference::kHighSide}})
          .value_or(run.roll_reference);
  for (TomlTable& step : table.FindTables("step")) run.steps.push_back(ReadStep(step));
  if (run.steps.empty()) table.RefuseAbsent("step", "is missing: a run has [[run.step]]");
  return run;
}

SimulatedEarth ReadSimulatedEarth(TomlTable table) {
  SimulatedEarth earth;
  const auto latitude = table.FindNumber("latitude_deg", kLatitudeDeg);
  earth.latitude = table.Need("latitude_deg", latitude) * kDeg;
  table.Read("longitude_deg", earth.longitude, kDeg, kLongitudeDeg);
  table.Read("height_m", earth.height, 1, {.min = -12'000, .max = 10'000});
  table.Read("rate_rad_per_s", earth.rate, 1, kNotNegative);
  table.Read("gravity_anomaly_mps2", earth.gravity_anomaly, 1, {.min = -0.01, .max = 0.01});
  table.Read("gravity_gradient_anomaly_per_s2", earth.gravity_gradient_anomaly, 1,
             {.min = -1e-5, .max = 1e-5});
  ReadVector(table, "field_nt", earth.field_L, units::kNanotesla);
  return earth;
}

SimulatedTool ReadSimulatedTool(TomlTable table, const NoiseCoefficients* noise,
                                std::uint64_t seed) {
  SimulatedTool tool;
  table.Read("has_gz", tool.has_gz);
  table.Read("has_mag", tool.has_mag);
  table.Read("sensor_below_reference_m", tool.sensor_below_reference);
  tool.temperature = static_cast<float>(
      table.FindNumber("temperature_degc", {.min = -273.15, .max = 1000}).value_or(20));
  const ErrorPriors priors = ReadPriors(table);
  tool.errors = DrawToolErrors(priors, noise ? *noise : ReadCoefficients(table), seed);
  ReadActualGyroErrors(table, tool.errors);
  ReadActualOtherErrors(table, tool.errors);
  return tool;
}

SimulatedStreams ReadSimulatedStreams(TomlTable table) {
  SimulatedStreams streams;
  table.Read("imu_hz", streams.imu_hz, 1,
             {.min = SimulatedStreams::kImuHzLeast, .max = SimulatedStreams::kImuHzMost});
  table.Read("depth_hz", streams.depth_hz, 1, {.min = 0, .max = 1e5});
  ReadInt32(table, "batch", streams.batch, 1);
  ReadInt32(table, "overlap", streams.overlap, 0);
  table.Read("loss_probability", streams.loss_probability, 1, {.min = 0, .max = 1});
  for (const auto& row :
       table.FindRows("outages_s", 2).value_or(std::vector<std::vector<double>>())) {
    if (!(row[1] > row[0])) table.Refuse("outages_s", "an outage ends later than it begins");
    streams.outages.push_back({.begin = row[0], .end = row[1]});
  }
  // [us]: in nanoseconds half of what an int64 holds, the other half being left for the run.
  constexpr std::int64_t kBeginMax = std::numeric_limits<std::int64_t>::max() / 2000;
  if (const auto us = table.FindInteger("begin_utime_us", 0, kBeginMax)) {
    streams.begin_utc.ns = *us * 1000;
  }
  ReadInt32(table, "session", streams.session, 0);
  ReadInt32(table, "run", streams.run, 0);
  ReadInt32(table, "tool", streams.tool, 0);
  return streams;
}

}  // namespace wellgyro
