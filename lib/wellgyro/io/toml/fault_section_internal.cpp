#include "wellgyro/io/toml/fault_section_internal.h"

#include <string>
#include <string_view>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/simulation_file.h"

namespace wellgyro {
namespace {

using Cause = SimulatedFault::Cause;

struct CauseKey {
  std::string_view word;
  Cause cause;
  std::string_view size;  ///< key of its size; empty: it has none
  double unit;
  bool axis;
};

constexpr CauseKey kCauses[] = {
    {"gyro_step", Cause::kGyroStep, "size_deg_per_h", units::kDegPerHour, true},
    {"gyro_ramp", Cause::kGyroRamp, "size_deg_per_h2", units::kDegPerHour2, true},
    {"gyro_temperature", Cause::kGyroTemperature, "size_deg_per_h", units::kDegPerHour, true},
    {"gyro_scale", Cause::kGyroScale, "size", 1, true},
    {"gyro_misalignment", Cause::kGyroMisalignment, "size_rad", 1, true},
    {"mass_unbalance", Cause::kMassUnbalance, "size_deg_per_h_per_g", units::kDegPerHourPerG,
     false},
    {"quadrature", Cause::kQuadrature, "size_deg_per_h_per_g", units::kDegPerHourPerG, false},
    {"accel_bias", Cause::kAccelBias, "size_mps2", 1, true},
    {"accel_scale", Cause::kAccelScale, "size", 1, true},
    {"toolface_slip", Cause::kToolfaceSlip, "size_deg", units::kDeg, false},
    {"time_skew", Cause::kTimeSkew, "size_s", 1, false},
    {"latitude", Cause::kLatitude, "size_deg", units::kDeg, false},
    {"samples_lost", Cause::kSamplesLost, "size_s", 1, false},
    {"gyro_spike", Cause::kGyroSpike, "size_deg_per_s", units::kDeg, true},
    {"accel_spike", Cause::kAccelSpike, "size_mps2", 1, true},
    {"gyro_noise", Cause::kGyroNoise, "size", 1, false},
    {"accel_noise", Cause::kAccelNoise, "size", 1, false},
    {"rest_creep", Cause::kRestCreep, "size_deg_per_min", units::kDeg / 60, false},
    {"rest_turn", Cause::kRestTurn, "size_deg", units::kDeg, false},
    {"swing", Cause::kSwing, "size_deg", units::kDeg, false},
    {"depth_step", Cause::kDepthStep, "size_m", 1, false},
    {"depth_scale", Cause::kDepthScale, "size", 1, false},
    {"depth_slip", Cause::kDepthSlip, "size_m", 1, false},
    {"depth_lag", Cause::kDepthLag, "size_s", 1, false},
    {"depth_frozen", Cause::kDepthFrozen, "", 1, false},
    {"magnetic_turn", Cause::kMagneticTurn, "size_deg", units::kDeg, false},
    {"gyro_stuck", Cause::kGyroStuck, "", 1, true},
    {"accel_stuck", Cause::kAccelStuck, "", 1, true},
    {"gyro_dead", Cause::kGyroDead, "", 1, true},
    {"accel_dead", Cause::kAccelDead, "", 1, true},
    {"gyro_inverted", Cause::kGyroInverted, "", 1, true},
    {"accel_inverted", Cause::kAccelInverted, "", 1, true},
    {"gyros_swapped", Cause::kGyrosSwapped, "", 1, false},
    {"accels_swapped", Cause::kAccelsSwapped, "", 1, false},
    {"gyro_unit", Cause::kGyroUnit, "size", 1, false},
    {"vibration", Cause::kVibration, "size_mps2", 1, true},
    {"whirl", Cause::kWhirl, "size_deg", units::kDeg, false},
    {"utc_step", Cause::kUtcStep, "size_s", 1, false},
};

const CauseKey& CauseOf(TomlTable& table) {
  const std::string word = table.Need("cause", table.FindString("cause"));
  std::string all;
  for (const CauseKey& key : kCauses) {
    if (key.word == word) return key;
    all += fmt::format("{}{}", all.empty() ? "" : ", ", key.word);
  }
  table.Refuse("cause", fmt::format("\"{}\" is none of {}", word, all));
}

}  // namespace

std::string FaultHelp() {
  std::string text;
  for (const CauseKey& key : kCauses) {
    text += fmt::format("  {:<18}{}{}{}\n", key.word, key.axis ? "axis" : "",
                        key.axis && !key.size.empty() ? ", " : "", key.size);
  }
  return text;
}

SimulatedFault ReadFault(TomlTable table) {
  const CauseKey& key = CauseOf(table);
  SimulatedFault fault;
  fault.cause = key.cause;
  if (!key.size.empty()) {
    fault.size = key.unit * table.Need(key.size, table.FindNumber(key.size, kAnyNumber));
  }
  if (key.axis) {
    fault.axis = table.Need("axis", table.FindWord<int>("axis", {{"x", 0}, {"y", 1}, {"z", 2}}));
  }
  table.Read("begin_s", fault.begin, 1, kNotNegative);
  table.Read("end_s", fault.end, 1, kPositive);
  table.Read("every_s", fault.period, 1, kPositive);
  if (!(fault.end > fault.begin)) table.Refuse("end_s", "must be later than begin_s");
  return fault;
}

}  // namespace wellgyro
