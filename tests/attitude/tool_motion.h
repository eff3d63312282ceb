#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/attitude/increment_builder.h"
#include "wellgyro/record/increment.h"
#include "wellgyro/record/sample.h"

/// The truth increments are held against: a tool whose attitude is a known function of time, and
/// what gyros and accelerometers fixed to it read, by differentiating that function.
namespace wellgyro::motion {

using Attitude = std::function<Eigen::Matrix3d(double seconds)>;  ///< R_LT
using Angle = std::function<double(double seconds)>;              ///< [rad]
using Tilt = std::function<Eigen::Vector2d(double seconds)>;      ///< of the tool in its hole [rad]

/// A tool that rolls by `roll` in a hole whose inclination undulates by half a degree about
/// `inclination_deg` and whose azimuth grows; it may whirl.
Attitude InHole(double inclination_deg, Angle roll, Tilt whirl = nullptr);
Angle Turning(double rpm);

Eigen::Matrix3d InertialAttitude(const Attitude& attitude, double t);  ///< R_IT
constexpr double kGravity = 9.80665;

struct Sensing {
  ErrorVector error = ErrorVector::Zero();
  bool has_gz = false;
};
/// Rate and specific force at one instant, errors in.
void SenseAt(const Attitude& attitude, const Sensing& sensing, double t, Eigen::Vector3d& w_IT_T,
             Eigen::Vector3d& f_T);
/// Means over the periods from 0 on by quadrature.
std::vector<ImuSample> Samples(const Attitude& attitude, const Sensing& sensing, double rate_hz,
                               double seconds);

/// Increments of `every` seconds, cut wherever in a sample that is.
std::vector<Increment> Increments(const std::vector<ImuSample>& samples, double every,
                                  const IncrementOptions& options);

/// R_IT(begin)^T R_IT(end) as the increment says, with psi wrong by a line of `delta` over it.
Eigen::Matrix3d Turned(const Increment& increment, double delta);
/// Axis (x, y) and roll (z) by which `increment` misses the truth from `t` on, the roll put into
/// `delta` as an estimator does, which then is how much it was.
Eigen::Vector2d Miss(const Increment& increment, const Attitude& attitude, double t, double& delta);

/// An increment in the tool's frame at its begin, the roll put right as an estimator does.
struct Resolved {
  Eigen::Vector2d turn;
  Eigen::Vector3d force;
};
Resolved AtBegin(const Increment& increment, const Attitude& attitude, double begin);

}  // namespace wellgyro::motion
