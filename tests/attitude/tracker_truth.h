#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/attitude/tracker.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/knot.h"
#include "wellgyro/record/sample.h"

namespace wellgyro::truth {

/// Motion of a tool at one instant, with the derivatives that rates and forces need.
struct Motion {
  double inclination = 0, inclination_rate = 0;
  double azimuth = 0, azimuth_rate = 0;
  double toolface = 0, toolface_rate = 0, toolface_acceleration = 0;
  double md = 0, speed = 0, acceleration = 0;
};
using Path = std::function<Motion(double)>;

/// Sensor errors by Knot::Source, and where the accelerometers sit.
struct Sensors {
  Knot::SourceVector error = Knot::SourceVector::Zero();
  Eigen::Vector3d p_accel_T = Eigen::Vector3d::Zero();
  bool has_gz = false;
};

/// Place whose latitude and gravity stay the same however far the tool goes; the level frame turns
/// all the same with the Earth and with the travel.
Site SiteOf(double latitude);

/// Rate and specific force at one instant, straight from vectors in the level frame.
void SenseAt(const Path& path, const Sensors& sensors, const Site& site, double t,
             Eigen::Vector3d& w_IT_T, Eigen::Vector3d& f_T);

/// Sample `k` of a tool sampling at `rate` from t = 0: means by Gauss-Legendre quadrature.
ImuSample SampleAt(const Path& path, const Sensors& sensors, const Site& site, std::int64_t k,
                   double rate);
AlongHole AlongAt(const Path& path, double t);

/// 0.6 m/s through a hole that undulates by 1.8 deg in ten minutes and swings by 50 deg in an hour,
/// turning at 3 rpm with a roll wave of 25 deg in 23 s.
Path Hour(double inclination_deg);
/// The same with a tool that slides without turning.
Path Slide(double inclination_deg);

struct Flight {
  TrackerOptions options;
  Sensors sensors;
  double rate = 10;      // [Hz]
  double seconds = 600;  // [s]
  double every = 1;      // length of a knot [s]
  bool azimuth = true;   // given to the tracker every second
  Site site = SiteOf(FromDegrees(60));
};

/// The knots of a run along `path`, the last one shorter where `seconds` asks for it.
std::vector<Knot> Fly(const Path& path, const Flight& flight);

/// Azimuth through a row of knots from a known start: each knot's turn, and the Earth's and the
/// transport rate's part from its cot. The reference for what a filter has to make of knots.
std::vector<double> Propagate(double azimuth, double inclination, const std::vector<Knot>& knots,
                              const Site& site);

}  // namespace wellgyro::truth
