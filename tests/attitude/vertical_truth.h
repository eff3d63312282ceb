#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/earth/earth.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/sample.h"

/// A tool that passes near vertical: its axis follows a great circle at a steady rate while it
/// turns about itself. Rates and forces come from the rotation, not from angles.
namespace wellgyro::vertical_truth {

struct Crossing {
  double closest = 0;   // of the axis to vertical [rad]
  double rpm = 0;       // of the tool about its axis, against the path; reached in spin_up
  double spin_up = 30;  // [s]
  double path = 0;      // length of the great circle [rad]
  double seconds = 540;
  double azimuth = 0.6;  // direction of the path at its closest [rad]
  double wave = 0;       // of the roll: amplitude [rad]
  double wave_seconds = 23;
  double speed = 0.5;  // [m/s]
};

/// Twelve degrees of path in nine minutes past vertical at `closest_deg`.
Crossing Pass(double rpm, double closest_deg);

/// Such a crossing; `best` is the best rms error of azimuth at the end that high-side form, locked
/// quaternion and multiplicative filters with a large and with a small walk reached there [deg].
struct Cell {
  double rpm, closest, best;
};
inline constexpr Cell kCells[] = {
    {0, 0.05, 0.55},  {0, 0.2, 0.47},  {0, 0.5, 0.31}, {0, 2, 0.21},   {0.3, 0.05, 0.96},
    {0.3, 0.5, 0.74}, {3, 0.05, 0.85}, {3, 0.2, 0.51}, {3, 0.5, 0.19}, {3, 2, 0.08}};

/// Where the crossings are, at 60 deg north.
Site Norway();

struct Errors {
  NoiseCoefficients gyro;
  ErrorPriors priors;
};

/// Bias 0.1 deg/h, random walk 0.01 deg/rt-h, accelerometers 0.1 mg and 50 ug/rt-Hz.
Errors Tactical();

Eigen::Matrix3d AttitudeAt(const Crossing& crossing, double t);
double AzimuthAt(const Crossing& crossing, double t);
AlongHole AlongAt(const Crossing& crossing, double t);

/// Errors of (inclination, azimuth, toolface) at `t`.
Eigen::Vector3d ErrorsAt(const Crossing& crossing, double t, const AttitudeSample& a);

/// Samples of the whole passage from a perfect tool.
std::vector<ImuSample> Samples(const Crossing& crossing, const Site& site, double rate,
                               bool has_gz);

/// The same with errors drawn by `seed`.
void AddErrors(const Errors& errors, std::uint64_t seed, std::vector<ImuSample>& samples);

}  // namespace wellgyro::vertical_truth
