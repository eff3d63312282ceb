#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/survey/run/estimated_run.h"
#include "wellgyro/survey/run_adjuster.h"

#include "support/drawn_errors.h"
#include "support/simulated_survey.h"

/// One-hour runs through a hole that undulates by 1.8 deg while its azimuth swings, from simulated
/// sensors to what a run leaves behind.
namespace wellgyro::testing {

/// What is known before the run is estimated as a whole: on the way, each knot as it came.
inline SmoothedRun KnownOnTheWay(const RunHistory& history) {
  return {history.attitude, history.states, std::nullopt};
}

/// Keeps what a run leaves, and adjusts nothing.
struct KeepingAdjuster : RunAdjuster {
  SmoothedRun Adjust(const RunHistory& history) const override {
    kept = history;
    return KnownOnTheWay(history);
  }
  mutable RunHistory kept;
};

struct Hour {
  double inclination_deg = 60, build_deg = 0;  ///< grows by so much over the run
  double undulation_deg = 1.8;
  double azimuth_deg = 40, swing_deg = 50;
  double rpm = 3;  ///< with a swing in 23 s on it; zero: slides, roll wandering slowly
  double roll_amplitude_deg = 25;
  double latitude_deg = 60;
  int stops = 3;  ///< of 180 s each, spread over the run, the first at its begin
  double stop_seconds = 180;
  bool and_back = false;  ///< the same way out, sliding
  double imu_hz = 10;
  double speed = 0.6;
  double minutes = 60;
  double depth_resolution = 0.01;
  NoiseCoefficients noise;
  ErrorPriors errors;
};

/// Section 4 of the literature table: bias .5 deg/h, N .01 deg/sqrt h, K .05 deg/h/sqrt h, mass
/// unbalance and quadrature .1 deg/h/g, accelerometers .1 mg and 50 ug/sqrt Hz.
inline Hour StrongDrift() {
  Hour hour;
  hour.noise.angle_random_walk = 0.01 * units::kDegPerSqrtHour;
  hour.noise.rate_random_walk = 0.05 * units::kDegPerHourSqrtHour;
  hour.errors.gyro_bias_sigma = 0.5 * units::kDegPerHour;
  hour.errors.mass_unbalance_sigma = 0.1 * units::kDegPerHourPerG;
  hour.errors.quadrature_sigma = 0.1 * units::kDegPerHourPerG;
  hour.errors.accel_bias_sigma = 0.1 * units::kMilliG;
  hour.errors.accel_noise = 0.05 * units::kMilliG;
  hour.errors.depth_sigma = 0.01;
  return hour;
}

/// Tactical grade: bias .1 deg/h, N .01 deg/sqrt h, accelerometers .1 mg and 50 ug/sqrt Hz.
inline Hour Tactical() {
  Hour hour = StrongDrift();
  hour.noise.rate_random_walk = 0;
  hour.errors.gyro_bias_sigma = 0.1 * units::kDegPerHour;
  hour.errors.mass_unbalance_sigma = 0;
  hour.errors.quadrature_sigma = 0;
  hour.stops = 0;
  return hour;
}

inline Simulation SimulationOf(const Hour& hour, std::uint64_t seed) {
  Simulation s;
  const double moving = hour.minutes * 60 - hour.stops * hour.stop_seconds;
  const double way = hour.speed * (hour.and_back ? moving / 2 : moving);
  s.well.begin_md = 0;
  s.well.end_md = way + 50;
  s.well.inclination.start = FromDegrees(hour.inclination_deg);
  if (hour.undulation_deg > 0) {
    s.well.inclination.terms.push_back(
        {.amplitude = FromDegrees(hour.undulation_deg), .period = 360});
  }
  if (hour.build_deg != 0) {
    s.well.inclination.terms.push_back({.rate = FromDegrees(hour.build_deg) / way});
  }
  s.well.azimuth.start = FromDegrees(hour.azimuth_deg);
  if (hour.swing_deg > 0) {
    s.well.azimuth.terms.push_back({.amplitude = FromDegrees(hour.swing_deg), .period = way});
  }
  s.earth.latitude = FromDegrees(hour.latitude_deg);
  s.run.start_md = 5;
  s.run.roll_reference = RollReference::kHighSide;
  const int legs = std::max(1, hour.stops);
  const RunRoll spin{hour.rpm * kTwoPi / 60, FromDegrees(hour.roll_amplitude_deg),
                     hour.rpm > 0 ? 23.0 : 900.0, 0};
  if (hour.stops == 0) s.run.steps.push_back(RunStop{.seconds = 5});
  for (int leg = 0; leg < legs; ++leg) {
    if (hour.stops > 0) s.run.steps.push_back(RunStop{.seconds = hour.stop_seconds});
    s.run.steps.push_back(
        RunMove{.to_md = 5 + way * (leg + 1) / legs, .speed = hour.speed, .roll = spin});
  }
  if (hour.and_back) {
    s.run.steps.push_back(RunStop{.seconds = 30});
    s.run.steps.push_back(RunMove{.to_md = 5, .speed = hour.speed, .roll = spin});
  }
  s.run.steps.push_back(RunStop{.seconds = 5});
  s.streams.imu_hz = hour.imu_hz;
  s.seed = seed;
  if (seed != 0) {
    DrawErrors(hour.errors, hour.noise, seed, s);
    s.tool.errors.depth_resolution = hour.depth_resolution;
  }
  return s;
}

inline Job JobOf(const Hour& hour) {
  Job job;
  job.well.latitude = FromDegrees(hour.latitude_deg);
  job.noise = hour.noise;
  job.errors = hour.errors;
  job.tie_in.md = 5;
  job.tie_in.tvd = 0;
  job.stations.every = 10;
  return job;
}

/// Told the azimuth at the begin, `sigma_deg` off by the seed's draw.
inline Job ExternalJob(const Hour& hour, std::uint64_t seed, double sigma_deg) {
  Job job = JobOf(hour);
  Random random(1000 + seed);
  job.alignment.method = AlignmentSpec::Method::kExternal;
  job.alignment.sigma_azimuth = FromDegrees(sigma_deg);
  job.alignment.azimuth = Truth(SimulationOf(hour, seed)).At(0).azimuth;
  if (seed != 0) job.alignment.azimuth += job.alignment.sigma_azimuth * random.Normal();
  return job;
}

struct Flown {
  Job job;
  RunHistory history;
  std::vector<TruthState> truth;  ///< at the end of every knot
};

/// As a surveyor estimates it.
inline SmoothedRun EstimateOf(const Flown& flown) { return EstimatedRun(flown.job, flown.history); }

inline double AzimuthError(const Flown& flown, const SmoothedRun& run, std::size_t i) {
  return WrapPi(run.attitude[i].azimuth - flown.truth[i].azimuth);
}

/// Plays a run through a surveyor.
inline Flown Fly(const Simulation& simulation, const Job& job) {
  Sink sink;
  const KeepingAdjuster keeper;
  Surveyor surveyor(job, sink);
  AdjustBy(keeper, surveyor);
  Play(simulation, surveyor);
  surveyor.Finish();
  Flown flown;
  flown.job = job;
  flown.history = std::move(keeper.kept);
  const Truth truth(simulation);
  for (const RunKnot& knot : flown.history.knots) {
    const double t =
        (knot.increment.time - ToolTime{}).seconds() - simulation.tool.errors.clock_offset;
    flown.truth.push_back(truth.At(t));
  }
  return flown;
}

inline Flown Fly(const Hour& hour, const Job& job, std::uint64_t seed) {
  return Fly(SimulationOf(hour, seed), job);
}

}  // namespace wellgyro::testing
