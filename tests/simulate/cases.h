#pragma once

#include <cmath>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/simulate/simulation.h"

namespace wellgyro {

/// A hole that builds from 3 to 63 deg and weaves in azimuth, by laws.
inline SimulatedWell WeavingWell() {
  SimulatedWell well;
  well.begin_md = 100;
  well.end_md = 2600;
  well.inclination.start = FromDegrees(3);
  well.inclination.terms = {
      {.begin_md = 300, .end_md = 1500, .ramp = 60, .rate = FromDegrees(60) / 1140},
      {.amplitude = FromDegrees(0.4), .period = 170, .phase = 0.3}};
  well.azimuth.start = FromDegrees(35);
  well.azimuth.terms = {
      {.rate = FromDegrees(20) / 1000},
      {.begin_md = 500, .end_md = 2500, .ramp = 200, .amplitude = FromDegrees(15), .period = 700}};
  return well;
}

/// Vertical from the surface, kicked off at 400 m, by stations.
inline SimulatedWell StationWell() {
  SimulatedWell well;
  well.stations = {{0, 0, 0},
                   {200, 0, 0},
                   {400, 0, 0},
                   {430, FromDegrees(3), FromDegrees(120)},
                   {460, FromDegrees(6), FromDegrees(121)},
                   {600, FromDegrees(20), FromDegrees(118)},
                   {800, FromDegrees(41), FromDegrees(125)},
                   {1000, FromDegrees(60), FromDegrees(130)},
                   {1300, FromDegrees(90), FromDegrees(128)},
                   {1400, FromDegrees(94), FromDegrees(131)}};
  return well;
}

/// Down and up the weaving well in an hour and a half, with index turns and a rolling tool.
inline Simulation WeavingRun() {
  Simulation s;
  s.well = WeavingWell();
  s.earth = {.latitude = FromDegrees(60), .longitude = FromDegrees(5), .height = 120};
  s.run.start_md = 150;
  s.run.start_toolface = FromDegrees(25);
  const RunRoll roll{.rate = kTwoPi / 20,  // 3 rpm
                     .amplitude = FromDegrees(25),
                     .period = 23,
                     .phase = 0.4};
  s.run.steps = {
      RunStop{.seconds = 60, .index_angles = {0, kPi}},
      RunMove{.to_md = 1300, .speed = 0.9, .ramp = 8, .roll = roll},
      RunStop{.seconds = 30, .toolface = FromDegrees(90)},
      RunMove{.to_md = 2400, .speed = 1.1, .ramp = 12, .roll = roll},
      RunStop{.seconds = 60},
      RunMove{.to_md = 600, .speed = 1.5, .ramp = 12, .roll = {.rate = -0.02}},
      RunStop{.seconds = 20},
  };
  return s;
}

/// At rest for `seconds` in a straight hole.
inline Simulation AtRest(double inclination, double azimuth, double toolface, double seconds) {
  Simulation s;
  s.well.begin_md = 0;
  s.well.end_md = 3000;
  s.well.inclination.start = inclination;
  s.well.azimuth.start = azimuth;
  s.earth = {.latitude = FromDegrees(60), .longitude = 0, .height = 0};
  s.run.start_md = 1000;
  s.run.start_toolface = toolface;
  s.run.steps = {RunStop{.seconds = seconds}};
  return s;
}

}  // namespace wellgyro
