#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/earth/earth.h"
#include "wellgyro/record/along_hole.h"
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

struct Errors {
  NoiseCoefficients gyro;
  ErrorPriors priors;
};

/// Bias 0.1 deg/h, random walk 0.01 deg/rt-h, accelerometers 0.1 mg and 50 ug/rt-Hz.
Errors Tactical();

Eigen::Matrix3d AttitudeAt(const Crossing& crossing, double t);
double AzimuthAt(const Crossing& crossing, double t);
AlongHole AlongAt(const Crossing& crossing, double t);

/// Samples of the whole passage from a perfect tool.
std::vector<ImuSample> Samples(const Crossing& crossing, const Site& site, double rate,
                               bool has_gz);

/// The same with errors drawn by `seed`.
void AddErrors(const Errors& errors, std::uint64_t seed, std::vector<ImuSample>& samples);

}  // namespace wellgyro::vertical_truth
