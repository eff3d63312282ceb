#pragma once

#include <array>
#include <vector>

#include "wellgyro/base/units.h"
#include "wellgyro/plan/plan_case.h"

namespace wellgyro::test {

/// A tool of fibre-optic grade, all its errors stated.
inline void TakeGoodTool(PlanCase& c) {
  c.gyro.angle_random_walk = 0.005 * units::kDegPerSqrtHour;
  c.gyro.rate_random_walk = 0.03 * units::kDegPerHourSqrtHour;
  ErrorPriors& e = c.errors;
  e.gyro_bias_sigma = 0.1 * units::kDegPerHour;
  e.mass_unbalance_sigma = e.quadrature_sigma = 0.02 * units::kDegPerHourPerG;
  e.gyro_scale_sigma = e.gyro_misalignment_sigma = e.accel_misalignment_sigma = 1e-4;
  e.accel_bias_sigma = 5e-4;
  e.accel_scale_sigma = 5e-5;
  e.accel_noise = 2e-4;
  e.roll_offset_sigma = 0.02 * units::kDeg;
  e.time_skew_sigma = 1e-3;
  e.latitude_sigma = 1e-3 * units::kDeg;
}

/// Stations of MD [m], inclination and azimuth [deg] at a latitude [deg]; the tool rolls by `rpm`.
inline PlanCase CaseOf(const std::vector<std::array<double, 3>>& stations, double latitude,
                       double rpm) {
  std::vector<double> md, inclination, azimuth;
  for (const auto& s : stations) {
    md.push_back(s[0]);
    inclination.push_back(s[1] * units::kDeg);
    azimuth.push_back(s[2] * units::kDeg);
  }
  PlanCase c{.well = Trajectory(md, inclination, azimuth, {0, 0, md.front()}),
             .site = SiteAt(latitude * units::kDeg, 0)};
  TakeGoodTool(c);
  c.way.begin_md = md.front();
  c.way.end_md = md.back();
  c.way.roll_rate = rpm * kTwoPi / 60;
  return c;
}

inline PlanCase Slant() {
  return CaseOf({{300, 5, 38},
                 {600, 20, 40},
                 {900, 40, 41},
                 {1200, 58, 40},
                 {1500, 60, 40},
                 {2000, 60.5, 41},
                 {2500, 59.5, 39.5},
                 {3000, 60, 40}},
                60, 1);
}
inline PlanCase SShape() {
  return CaseOf({{300, 5, 110},
                 {600, 18, 112},
                 {900, 33, 113},
                 {1100, 36, 113},
                 {1700, 36, 112},
                 {2000, 28, 111},
                 {2300, 15, 109},
                 {2550, 6, 107},
                 {2900, 5.5, 106}},
                60, 0);
}
inline PlanCase Horizontal() {
  return CaseOf({{300, 5, 20},
                 {600, 15, 25},
                 {900, 35, 36},
                 {1200, 58, 50},
                 {1500, 80, 62},
                 {1700, 89, 66},
                 {2200, 90, 66},
                 {2700, 89.5, 65.5},
                 {3000, 90, 66}},
                60, 0.5);
}

/// The hole as it was drilled: turned and leaning by this much [deg] against its plan.
inline PlanCase Drilled(const PlanCase& c, double inclination, double azimuth) {
  std::vector<double> md, inc, azi;
  for (std::size_t i = 0; i < c.well.size(); ++i) {
    const TrajectoryPoint p = c.well.station(i);
    md.push_back(p.md);
    inc.push_back(p.inclination + inclination * units::kDeg);
    azi.push_back(p.azimuth + azimuth * units::kDeg);
  }
  PlanCase truth = c;
  truth.well = Trajectory(md, inc, azi, {0, 0, md.front()});
  return truth;
}

}  // namespace wellgyro::test
