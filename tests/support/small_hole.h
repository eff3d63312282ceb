#pragma once

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/simulate/simulation.h"
#include "wellgyro/survey/job.h"

#include "support/testing.h"

/// A hole of some hundred metres, a stop at either end, and the job of its survey.
namespace wellgyro::testing {

struct SmallHole {
  double inclination_deg = 30;
  double build_deg = 0;  ///< every metre
  double azimuth_deg = 45;
  double latitude_deg = 55;
  double to_md = 300;  ///< the hole goes on for 100 m
  double rpm = 0;
  double imu_hz = 20, depth_hz = 4;
  double walk = 0.005;       ///< of angle [deg/sqrt(h)]
  double accel_noise_g = 0;  ///< [g/sqrt(Hz)]
  double stations_every = 20;
};

inline Simulation SimulationOf(const SmallHole& hole) {
  Simulation s;
  s.well.end_md = hole.to_md + 100;
  s.well.inclination.start = FromDegrees(hole.inclination_deg);
  if (hole.build_deg != 0) {
    s.well.inclination.terms.push_back({.rate = FromDegrees(hole.build_deg)});
  }
  s.well.azimuth.start = FromDegrees(hole.azimuth_deg);
  s.earth.latitude = FromDegrees(hole.latitude_deg);
  s.run.roll_reference = RollReference::kHighSide;
  s.run.steps = {RunStop{.seconds = 90},
                 RunMove{.to_md = hole.to_md, .roll = {.rate = hole.rpm * kTwoPi / 60}},
                 RunStop{.seconds = 90}};
  s.streams.imu_hz = hole.imu_hz;
  s.streams.depth_hz = hole.depth_hz;
  s.tool.errors.gyro_noise.angle_random_walk = hole.walk * units::kDegPerSqrtHour;
  s.tool.errors.accel_noise = hole.accel_noise_g * units::kStandardGravity;
  return s;
}

inline Job JobOf(const SmallHole& hole) {
  Job job;
  job.well.latitude = FromDegrees(hole.latitude_deg);
  job.noise.angle_random_walk = hole.walk * units::kDegPerSqrtHour;
  job.errors.accel_noise = hole.accel_noise_g * units::kStandardGravity;
  job.stations.every = hole.stations_every;
  return job;
}

/// Of the hole as it stands above.
inline Simulation Slant() { return SimulationOf(SmallHole{}); }
inline Job SlantJob() { return JobOf(SmallHole{}); }

}  // namespace wellgyro::testing
