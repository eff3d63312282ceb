#include <cmath>

#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/survey/verdict/known_causes_internal.h"
#include "wellgyro/survey/verdict/run_diagnosis.h"

namespace wellgyro {
namespace {

using Kind = CauseSpec::Kind;

constexpr double kOne = 1;  // unit of what is stated in SI
constexpr std::string_view kLatitudeSign = "latitude_sign";
constexpr std::string_view kCalibrate =
    "widen its sigma in [errors], run again, calibrate the tool";
constexpr std::string_view kRamp =
    "state its rate_ramp in [noise], run again; let the tool warm up, calibrate it";
constexpr std::string_view kWarm = "calibrate the tool over temperature, run again";
constexpr std::string_view kBench =
    "the run is good to its end only with the step told: bench "
    "the tool, survey the part below again";
constexpr std::string_view kSpike = "look at the samples there; leave them out and run again";
constexpr std::string_view kNotAtRest =
    "the tool was not at rest: leave the stop out and run again";

// Sizes by which a tool, or a job, is out of its class: a judgement, some five to ten times what
// calibrated tools have. Bayes factors change little with them, by ln 4 where they are wrong by 4:
// of simulated faults in a slant 91.0 % are found, 97.0 % of these rightly named; with sizes a
// quarter of theirs 86.9 and 93.5 %, four times theirs 89.7 and 98.3 %.
constexpr KnownCause kEntries[] = {
    {"gyro_bias_x", Kind::kConstant, kGyroBiasX, 0.5, units::kDegPerHour, "deg/h", kCalibrate},
    {"gyro_bias_y", Kind::kConstant, kGyroBiasY, 0.5, units::kDegPerHour, "deg/h", kCalibrate},
    {"gyro_ramp_x", Kind::kConstant, kRampX, 0.3, units::kDegPerHour2, "deg/h2", kRamp},
    {"gyro_ramp_y", Kind::kConstant, kRampY, 0.3, units::kDegPerHour2, "deg/h2", kRamp},
    {"gyro_temperature_x", Kind::kConstant, kWarmthX, 0.3, units::kDegPerHour, "deg/h", kWarm},
    {"gyro_temperature_y", Kind::kConstant, kWarmthY, 0.3, units::kDegPerHour, "deg/h", kWarm},
    {"mass_unbalance", Kind::kConstant, kMassUnbalance, 0.15, units::kDegPerHourPerG, "deg/h/g",
     kCalibrate},
    {"quadrature", Kind::kConstant, kQuadrature, 0.15, units::kDegPerHourPerG, "deg/h/g",
     kCalibrate},
    {"gyro_scale_x", Kind::kConstant, kGyroScaleX, 1e-3, kOne, "1", kCalibrate},
    {"gyro_scale_y", Kind::kConstant, kGyroScaleY, 1e-3, kOne, "1", kCalibrate},
    {"gyro_misalignment_x", Kind::kConstant, kMisalignmentX, 1e-3, kOne, "rad", kCalibrate},
    {"gyro_misalignment_y", Kind::kConstant, kMisalignmentY, 1e-3, kOne, "rad", kCalibrate},
    {"toolface_offset", Kind::kConstant, kToolfaceOffset, 0.2, units::kDeg, "deg", kCalibrate},
    {"time_skew", Kind::kConstant, kTimeSkew, 0.01, kOne, "s",
     "correct the stamps of the accelerometers, run again"},
    {"accel_bias_x", Kind::kConstant, kAccelBiasX, 3e-3, kOne, "m/s2", kCalibrate},
    {"accel_bias_y", Kind::kConstant, kAccelBiasY, 3e-3, kOne, "m/s2", kCalibrate},
    {"accel_bias_z", Kind::kConstant, kAccelBiasZ, 3e-3, kOne, "m/s2", kCalibrate},
    {"accel_scale_x", Kind::kConstant, kAccelScaleX, 1e-3, kOne, "1", kCalibrate},
    {"accel_scale_y", Kind::kConstant, kAccelScaleY, 1e-3, kOne, "1", kCalibrate},
    {"accel_scale_z", Kind::kConstant, kAccelScaleZ, 1e-3, kOne, "1", kCalibrate},
    {"accel_misalignment_x", Kind::kConstant, kAccelMisalignmentX, 1e-3, kOne, "rad", kCalibrate},
    {"accel_misalignment_y", Kind::kConstant, kAccelMisalignmentY, 1e-3, kOne, "rad", kCalibrate},
    {"gyro_bias_z", Kind::kConstant, kGyroBiasZ, 0.5, units::kDegPerHour, "deg/h", kCalibrate},
    {"gyro_scale_z", Kind::kConstant, kGyroScaleZ, 1e-3, kOne, "1", kCalibrate},
    {"gyro_ramp_z", Kind::kConstant, kRampZ, 0.3, units::kDegPerHour2, "deg/h2", kRamp},
    {"gyro_temperature_z", Kind::kConstant, kWarmthZ, 0.3, units::kDegPerHour, "deg/h", kWarm},
    {"latitude", Kind::kConstant, kLatitudeError, 0.4, units::kDeg, "deg",
     "correct the latitude of the job, run again"},
    // The Earth's rate along the vertical acts as a mass unbalance m, m g = w sin L: with the other
    // sign of L it is off by -2 w sin L, exactly.
    {kLatitudeSign, Kind::kGiven, kMassUnbalance, 0, kOne, "1",
     "correct the sign of the job's latitude, negative in the south, run again"},
    {"gravity", Kind::kConstant, kGravityError, 5e-3, kOne, "m/s2",
     "correct the well's place or elevation in the job, run again"},
    {kDepthScaleCause, Kind::kConstant, kDepthScaleError, 3e-3, kOne, "1",
     "compare depth with a tally, marks or a shoe, correct it, run again"},
    {"gyro_step_x", Kind::kOnset, kGyroBiasX, 0.5, units::kDegPerHour, "deg/h", kBench},
    {"gyro_step_y", Kind::kOnset, kGyroBiasY, 0.5, units::kDegPerHour, "deg/h", kBench},
    {"gyro_step_z", Kind::kOnset, kGyroBiasZ, 0.5, units::kDegPerHour, "deg/h", kBench},
    {"mass_unbalance_step", Kind::kOnset, kMassUnbalance, 0.15, units::kDegPerHourPerG, "deg/h/g",
     kBench},
    {"accel_step_x", Kind::kOnset, kAccelBiasX, 3e-3, kOne, "m/s2", kBench},
    {"accel_step_y", Kind::kOnset, kAccelBiasY, 3e-3, kOne, "m/s2", kBench},
    {"accel_step_z", Kind::kOnset, kAccelBiasZ, 3e-3, kOne, "m/s2", kBench},
    {"toolface_slip", Kind::kOnset, kToolfaceOffset, 0.2, units::kDeg, "deg",
     "tighten gyros and accelerometers against each other, survey the part below again"},
    {"samples_lost", Kind::kOnset, kTimeSkew, 0.05, kOne, "s",
     "restore the numbering of the samples, run again"},
    {"gyro_spike", Kind::kGyroSpike, 0, 0.05, units::kDeg, "deg", kSpike},
    {"accel_spike", Kind::kAccelSpike, 0, 0.05, kOne, "m/s2",
     "look at the samples and the depth marks there; leave them out and run again"},
    {kRestMotionCause, Kind::kRestMotion, 0, 0.01, units::kDeg, "deg", kNotAtRest},
    {"azimuth_tie", Kind::kTie, 0, 2.5, units::kDeg, "deg",
     "leave the azimuth from outside out, run again"},
    {"gyro_noise", Kind::kGyroNoise, 0, 1, kOne, "1",
     "state the noise as it is, run again; look for vibration"},
    {"accel_noise", Kind::kAccelNoise, 0, 1, kOne, "1",
     "state the noise as it is, run again; look for vibration"},
    {"other", Kind::kOther, 0, 1, kOne, "1", "survey the well again"},
};

struct SampleWords {
  std::string_view code, remedy;
};
constexpr std::string_view kRound = "round numbers in the converter, convert the log again";
constexpr std::string_view kReplaced =
    "they are replaced; look for shocks, bit errors, a loose connector; where they are many, "
    "survey "
    "again";
// Checks of samples and marks that by themselves name what is wrong.
constexpr SampleWords kOfSamples[] = {
    {"accel_dead", "mend the sensor, survey the well again"},
    {"accel_spikes", kReplaced},
    {"accel_stuck", "leave the stretch out; where it is long, survey the well again"},
    {"accel_truncated", kRound},
    {"accel_unit", "correct the unit or scale of the accelerometers in the tool file, run again"},
    {"azimuth_tie", "correct the azimuth from outside, or leave it out, run again"},
    {"axes_change", "look at the tool's wiring; leave the stretch out, survey it again"},
    {"axes", "correct the axes of the tool file, run again"},
    {"depth_jump", "correct the depth marks there, run again"},
    {"depth_lag", "correct the times of the depth marks, run again"},
    {"depth_reversed", "turn the sign of depth, run again"},
    {"depth_unit", "state the unit of depth as it is, run again"},
    {"gyro_dead", "mend the sensor, survey the well again"},
    {"gyro_spikes", kReplaced},
    {"gyro_stuck", "leave the stretch out; where it is long, survey the well again"},
    {"gyro_truncated", kRound},
    {"gyro_unit", "correct the unit or scale in the tool file, run again"},
    {"latitude", "correct the latitude of the job, run again"},
    {kRestMotionCause, kNotAtRest},
    {"tool_upside_down", "correct the axes or signs of the tool file, run again"},
};

}  // namespace

std::span<const KnownCause> KnownCauses() { return kEntries; }

std::string_view RemedyOfSamples(std::string_view check) {
  for (const SampleWords& words : kOfSamples) {
    if (check.starts_with(words.code)) return words.remedy;
  }
  return {};
}

std::vector<CauseSpec> CausesLookedFor(const Site& site) {
  std::vector<CauseSpec> specs;
  for (const KnownCause& entry : kEntries) {
    specs.push_back({entry.kind, entry.unknown, entry.size * entry.unit});
    if (entry.code != kLatitudeSign) continue;
    specs.back().size = -2 * kEarthRate * std::sin(site.latitude) / site.gravity;
  }
  return specs;
}

}  // namespace wellgyro
