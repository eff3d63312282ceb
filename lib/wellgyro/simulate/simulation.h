#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/time.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/simulate/fault.h"

/// What is to be simulated, as plain data: the hole, the run, the Earth, the tool's errors and its
/// streams. Whatever is left at its default is absent or perfect.
namespace wellgyro {

/// Direction of the hole at one measured depth; true azimuth at its own meridian.
struct WellPoint {
  double md = 0;           ///< [m]
  double inclination = 0;  ///< [rad]
  double azimuth = 0;      ///< [rad]
};

/// One term of an angle along the hole, w(md) times a rate and a wave. w is 1 from `begin_md` to
/// `end_md`, zero outside and rises and falls over `ramp` inside that stretch, twice
/// differentiable.
struct AngleTerm {
  std::optional<double> begin_md = {};  ///< absent: from the begin of the well, without a ramp [m]
  std::optional<double> end_md = {};    ///< absent: to the end of the well, without a ramp [m]
  double ramp = 0;                      ///< positive wherever begin_md or end_md is given [m]
  double rate = 0;                      ///< added to the angle's slope, times w [rad/m]
  double amplitude = 0;                 ///< of the wave added to the angle, times w [rad]
  double period = 0;                    ///< of the wave, along hole [m]
  double phase = 0;                     ///< of the wave's sine at begin_md [rad]
};

/// An angle along the hole: start + sum of terms.
struct AngleLaw {
  double start = 0;  ///< [rad]
  std::vector<AngleTerm> terms = {};
};

/// The hole, by stations or, when there are none, by laws of its angles. The curve laid through
/// the stations is the truth, not the stations: see HoleShape.
struct SimulatedWell {
  std::vector<WellPoint> stations = {};  ///< at least two, md increasing
  double smoothing = 10;      ///< length over which a kink between stations is rounded [m]
  double begin_md = 0;        ///< of a well by laws [m]
  double end_md = 0;          ///< of a well by laws [m]
  AngleLaw inclination = {};  ///< negative values pass through vertical
  AngleLaw azimuth = {};
  Eigen::Vector3d begin_p_WT_W = Eigen::Vector3d::Zero();  ///< where it begins [m]
};

/// What the tool's roll, as the run commands it, is counted from.
enum class RollReference {
  kNorth,     ///< toolface + azimuth is commanded: regular in a vertical hole
  kHighSide,  ///< toolface is commanded: the run must stay above 0.1 deg of inclination
};

/// The tool at rest at one place; with several index angles it stays `seconds` at each.
struct RunStop {
  double seconds = 0;                     ///< at rest, at each index position [s]
  std::vector<double> index_angles = {};  ///< roll from the stop's first position [rad]
  double turn_seconds = 10;               ///< of each turn, twice differentiable [s]
  std::optional<double> toolface = {};    ///< turn here first, the shorter way [rad]
  bool turns_back = false;                ///< to where it was before that, at the end
  ToolMode::Mode mode = ToolMode::Mode::kGyrocompass;  ///< announced while at rest
};

/// Roll while moving, faded in and out with the speed.
struct RunRoll {
  double rate = 0;       ///< [rad/s]
  double amplitude = 0;  ///< of an oscillation [rad]
  double period = 0;     ///< of the oscillation [s]
  double phase = 0;      ///< at the begin of the move [rad]
  /// The phase, and not the amplitude, comes and goes with the speed: the tool rests where the
  /// oscillation has brought it.
  bool rests_there = false;
};

/// A move along the hole; speed rises and falls over `ramp` with a continuous second derivative.
/// A move too short for that keeps its ramps and stays below `speed`.
struct RunMove {
  double to_md = 0;  ///< of the sensor point [m]
  double speed = 1;  ///< positive, in either direction [m/s]
  double ramp = 10;  ///< [s]
  RunRoll roll = {};
};

using RunStep = std::variant<RunStop, RunMove>;

struct SimulatedRun {
  double start_md = 0;        ///< of the sensor point [m]
  double start_toolface = 0;  ///< [rad]; in a vertical hole counted from north
  RollReference roll_reference = RollReference::kNorth;
  std::vector<RunStep> steps = {};
};

/// The Earth at the origin of W (TVD 0).
struct SimulatedEarth {
  double latitude = 0;                                ///< geodetic, WGS 84 [rad]
  double longitude = 0;                               ///< [rad]
  double height = 0;                                  ///< above mean sea level [m]
  double rate = 7.292115e-5;                          ///< [rad/s]
  double gravity_anomaly = 0;                         ///< at TVD 0, beyond EllipsoidAt() [m/s^2]
  double gravity_gradient_anomaly = 0;                ///< growth of that with TVD [1/s^2]
  Eigen::Vector3d field_L = Eigen::Vector3d::Zero();  ///< magnetic, north, east, down [T]
};

/// Actual errors of one tool (measured = truth + error), not sigmas: see DrawToolErrors.
struct ToolErrors {
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();          ///< [rad/s]
  Eigen::Vector3d gyro_scale = Eigen::Vector3d::Zero();         ///< [1]
  Eigen::Vector2d gyro_misalignment = Eigen::Vector2d::Zero();  ///< z seen by x, by y [rad]
  double mass_unbalance = 0;  ///< x drifts by m f_x, y by m f_y [rad/s per m/s^2]
  double quadrature = 0;      ///< x drifts by q f_y, y by -q f_x [rad/s per m/s^2]
  /// Of every gyro axis. Q rounds the accumulated angle to sqrt(12) Q. B without a correlation time
  /// is a constant drawn with sigma B; with one a Gauss-Markov process of sigma 1.075 B. The ramp
  /// has either sign.
  NoiseCoefficients gyro_noise = {};
  bool flicker = false;        ///< B as 1/f noise, Allan-flat from 4 s to 1e5 s, instead
  double gyro_full_scale = 0;  ///< [rad/s]; 0: none
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();   ///< [m/s^2]
  Eigen::Vector3d accel_scale = Eigen::Vector3d::Zero();  ///< [1]
  /// Off the diagonal: how much the axis of the row sees of that of the column [rad].
  Eigen::Matrix3d accel_misalignment = Eigen::Matrix3d::Zero();
  double accel_noise = 0;         ///< mean over t has sigma accel_noise/sqrt(t) [m/s^2/sqrt(Hz)]
  double accel_quantization = 0;  ///< step of the accumulated velocity [m/s]
  double accel_full_scale = 0;    ///< [m/s^2]; 0: none
  double roll_offset = 0;         ///< toolface read from the accelerometers too large by it [rad]
  double time_skew = 0;           ///< accelerometers read this long after their stamp [s]
  Eigen::Vector3d accel_lever_arm_T = Eigen::Vector3d::Zero();  ///< from the sensor point, in T [m]
  double mag_noise = 0;                                         ///< per sample and axis [T]
  double clock_offset = 0;      ///< tool time at the begin of the run [s]
  double clock_drift = 0;       ///< tool seconds per second, less one [1]
  double utc_jitter = 0;        ///< 1-sigma of the samples' UTC [s]
  double depth_offset = 0;      ///< [m]
  double depth_scale = 0;       ///< [1]
  double depth_noise = 0;       ///< 1-sigma, white from mark to mark [m]
  double depth_resolution = 0;  ///< of the encoder [m]
};

struct SimulatedTool {
  bool has_gz = false;
  bool has_mag = false;
  double sensor_below_reference = 0;  ///< along hole [m]
  float temperature = 20;             ///< [degC]
  ToolErrors errors = {};
};

/// Messages that never arrive: those whose last sample or mark lies in [begin, end).
struct Outage {
  double begin = 0;  ///< since the begin of the run [s]
  double end = 0;    ///< [s]
};

struct SimulatedStreams {
  static constexpr double kImuHzLeast = 0.5, kImuHzMost = 1e5;
  double imu_hz = 100;                           ///< kImuHzLeast to kImuHzMost
  double depth_hz = 10;                          ///< 0: no depth marks
  std::int32_t batch = 100;                      ///< new samples per message
  std::int32_t overlap = 0;                      ///< samples of the message before, sent again
  double loss_probability = 0;                   ///< of each message of samples
  std::vector<Outage> outages = {};              ///< of the messages of samples
  UtcTime begin_utc{1'767'225'600'000'000'000};  ///< of the run; 2026-01-01 by default
  std::int32_t session = 1;
  std::int32_t run = 1;
  std::int32_t tool = 0;
};

struct Simulation {
  SimulatedWell well;
  SimulatedRun run;
  SimulatedEarth earth;
  SimulatedTool tool;
  SimulatedStreams streams;
  std::vector<SimulatedFault> faults = {};
  std::uint64_t seed = 0;
};

}  // namespace wellgyro
