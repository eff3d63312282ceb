#include "attitude/vertical_truth.h"

#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"

namespace wellgyro::vertical_truth {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Gauss and Legendre's three.
constexpr std::array<double, 3> kNodes = {-0.7745966692414834, 0, 0.7745966692414834};
constexpr std::array<double, 3> kWeights = {5. / 18, 8. / 18, 5. / 18};

double PathRate(const Crossing& c) { return c.path / c.seconds; }

// The axis's direction at the closest approach, and the axis about which the path turns.
Matrix3d AtClosest(const Crossing& c) {
  return (AngleAxisd(c.azimuth, Vector3d::UnitZ()) * AngleAxisd(-c.closest, Vector3d::UnitX()))
      .toRotationMatrix();
}

double Spin(const Crossing& c, double t) {
  const double full = c.rpm * kTwoPi / 60;
  const double up = c.spin_up;
  const double turned = up <= 0 ? full * t : t < up ? full * t * t / (2 * up) : full * (t - up / 2);
  return turned + c.wave * std::sin(kTwoPi * t / c.wave_seconds);
}

double SpinRate(const Crossing& c, double t) {
  const double full = c.rpm * kTwoPi / 60;
  const double rate = t < c.spin_up ? full * t / c.spin_up : full;
  return rate + c.wave * kTwoPi / c.wave_seconds * std::cos(kTwoPi * t / c.wave_seconds);
}

void Sense(const Crossing& c, const Site& site, double t, Vector3d& w, Vector3d& f) {
  const Matrix3d R = AttitudeAt(c, t);
  const Vector3d axis = AtClosest(c).col(1);  // of the path, in L
  const Vector3d v = c.speed * R.col(2);
  const Vector3d earth =
      kEarthRate * Vector3d(std::cos(site.latitude), 0, -std::sin(site.latitude));
  const double east = v.y() / site.radius_east;
  const Vector3d carried(east, -v.x() / site.radius_north, -east * std::tan(site.latitude));
  const Vector3d w_LT = PathRate(c) * axis + SpinRate(c, t) * R.col(2);
  w = R.transpose() * (w_LT + earth + carried);
  const Vector3d turning = PathRate(c) * axis.cross(v);  // d v / dt in L
  const Vector3d force = turning + (2 * earth + carried).cross(v) - Vector3d(0, 0, site.gravity);
  f = R.transpose() * force;
}

}  // namespace

Crossing Pass(double rpm, double closest_deg) {
  Crossing c;
  c.closest = FromDegrees(closest_deg);
  c.rpm = rpm;
  c.path = FromDegrees(12);
  return c;
}

Site Norway() { return SiteAt(FromDegrees(60), 0); }

Errors Tactical() {
  Errors e;
  e.gyro.angle_random_walk = 0.01 * units::kDegPerSqrtHour;
  e.priors.gyro_bias_sigma = 0.1 * units::kDegPerHour;
  e.priors.accel_bias_sigma = 1e-4 * units::kStandardGravity;
  e.priors.accel_noise = 5e-5 * units::kStandardGravity;
  return e;
}

Matrix3d AttitudeAt(const Crossing& c, double t) {
  const Matrix3d closest = AtClosest(c);
  const double along = PathRate(c) * (t - c.seconds / 2);
  const Matrix3d path = AngleAxisd(along, closest.col(1)).toRotationMatrix() * closest;
  return path * AngleAxisd(Spin(c, t), Vector3d::UnitZ()).toRotationMatrix();
}

double AzimuthAt(const Crossing& c, double t) {
  const Vector3d axis = AttitudeAt(c, t).col(2);
  return std::atan2(axis.y(), axis.x());
}

AlongHole AlongAt(const Crossing& c, double t) { return {100 + c.speed * t, c.speed, 0, 0, true}; }

Vector3d ErrorsAt(const Crossing& c, double t, const AttitudeSample& a) {
  const Matrix3d R = AttitudeAt(c, t);
  return {a.inclination - std::atan2(std::hypot(R(0, 2), R(1, 2)), R(2, 2)),
          WrapPi(a.azimuth - std::atan2(R(1, 2), R(0, 2))),
          WrapPi(a.toolface - std::atan2(R(2, 1), -R(2, 0)))};
}

std::vector<ImuSample> Samples(const Crossing& c, const Site& site, double rate, bool has_gz) {
  const double dt = 1 / rate;
  const auto count = static_cast<std::int64_t>(std::lround(c.seconds * rate));
  std::vector<ImuSample> samples(static_cast<std::size_t>(count));
  for (std::int64_t k = 0; k < count; ++k) {
    ImuSample& s = samples[static_cast<std::size_t>(k)];
    const double begin = static_cast<double>(k) * dt;
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      Vector3d w, f;
      Sense(c, site, begin + dt / 2 * (1 + kNodes[i]), w, f);
      s.w_IT_T += kWeights[i] * w;
      s.f_T += kWeights[i] * f;
    }
    s.has_gz = has_gz;
    if (!has_gz) s.w_IT_T.z() = 0;
    s.stamp.period_ns = static_cast<std::int32_t>(std::lround(dt * 1e9));
    s.stamp.tool_time = ToolTime{k * s.stamp.period_ns};
    s.stamp.utc = UtcTime{k * s.stamp.period_ns};
    s.stamp.seq = k;
  }
  return samples;
}

void AddErrors(const Errors& e, std::uint64_t seed, std::vector<ImuSample>& samples) {
  Random random(seed);
  Vector3d gyro_bias, accel_bias;
  for (int i = 0; i < 3; ++i) {
    gyro_bias[i] = e.priors.gyro_bias_sigma * random.Normal();
    accel_bias[i] = e.priors.accel_bias_sigma * random.Normal();
  }
  for (ImuSample& s : samples) {
    const double root = std::sqrt(1e-9 * s.stamp.period_ns);
    for (int i = 0; i < 3; ++i) {
      s.w_IT_T[i] += gyro_bias[i] + e.gyro.angle_random_walk / root * random.Normal();
      s.f_T[i] += accel_bias[i] + e.priors.accel_noise / root * random.Normal();
    }
    if (!s.has_gz) s.w_IT_T.z() = 0;
  }
}

}  // namespace wellgyro::vertical_truth
