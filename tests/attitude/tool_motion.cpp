#include "attitude/tool_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "wellgyro/base/angle.h"

namespace wellgyro::motion {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d Exp(const Vector3d& v) {
  const double angle = v.norm();
  if (angle == 0) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, v / angle).toRotationMatrix();
}

Vector3d Log(const Matrix3d& R) {
  const Vector3d v = 0.5 * Vector3d(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  const double sine = v.norm();
  if (sine < 1e-9) return v;
  return v * (std::atan2(sine, 0.5 * (R.trace() - 1)) / sine);
}

Matrix3d About(int axis, double angle) { return Exp(angle * Vector3d::Unit(axis)); }

// The Earth's rate at 60 deg north, by the figure that every textbook has.
const Vector3d kEarth(7.292115e-5 * 0.5, 0, -7.292115e-5 * 0.8660254037844386);

}  // namespace

Attitude InHole(double inclination_deg, Angle roll, Tilt whirl) {
  return [=](double t) -> Matrix3d {
    const double tilt = FromDegrees(inclination_deg + 0.5 * std::sin(kTwoPi / 120 * t + 0.3));
    Matrix3d R = About(2, 1.2 + 3e-3 * t) * About(1, tilt);
    if (whirl) R = R * Exp(Vector3d(whirl(t).x(), whirl(t).y(), 0));
    return R * About(2, roll(t));
  };
}

Angle Turning(double rpm) {
  return [rpm](double t) { return 0.3 + rpm * kTwoPi / 60 * t; };
}

Matrix3d InertialAttitude(const Attitude& attitude, double t) {
  return Exp(kEarth * t) * attitude(t);
}

void SenseAt(const Attitude& attitude, const Sensing& sensing, double t, Vector3d& w_IT_T,
             Vector3d& f_T) {
  const auto across = [&](double h) {
    return Log(InertialAttitude(attitude, t - h).transpose() * InertialAttitude(attitude, t + h));
  };
  const double h = 1e-3;  // rounding 1e-13 rad/s, the rest of fifth order
  const Vector3d w = (8 * across(h) - across(2 * h)) / (12 * h);
  const Vector3d f = attitude(t).transpose() * Vector3d(0, 0, -kGravity);
  const ErrorVector& e = sensing.error;
  const double ahead = e(kToolfaceOffset) + e(kTimeSkew) * w.z();
  const Vector3d seen = About(2, ahead).transpose() * f;
  w_IT_T << w.x() + e(kGyroBiasX) + e(kMassUnbalance) * f.x() + e(kQuadrature) * f.y() +
                e(kGyroScaleX) * w.x() + e(kMisalignmentX) * w.z(),
      w.y() + e(kGyroBiasY) + e(kMassUnbalance) * f.y() - e(kQuadrature) * f.x() +
          e(kGyroScaleY) * w.y() + e(kMisalignmentY) * w.z(),
      sensing.has_gz ? w.z() * (1 + e(kGyroScaleZ)) + e(kGyroBiasZ) : 0;
  f_T = seen + Vector3d(e(kAccelBiasX), e(kAccelBiasY), e(kAccelBiasZ)) +
        Vector3d(e(kAccelScaleX) * seen.x() + e(kAccelShear) * seen.y() +
                     e(kAccelMisalignmentX) * seen.z(),
                 e(kAccelScaleY) * seen.y() + e(kAccelShear) * seen.x() +
                     e(kAccelMisalignmentY) * seen.z(),
                 e(kAccelScaleZ) * seen.z() + e(kAccelMisalignmentZX) * seen.x() +
                     e(kAccelMisalignmentZY) * seen.y());
  const double products[] = {seen.x() * seen.x(), seen.y() * seen.y(), seen.z() * seen.z(),
                             seen.x() * seen.y(), seen.y() * seen.z(), seen.z() * seen.x()};
  for (int i = 0; i < kSecondOrderSources; ++i) {
    f_T[i / 6] += e(kAccelSecondOrder + i) * products[i % 6];
  }
}

std::vector<ImuSample> Samples(const Attitude& attitude, const Sensing& sensing, double rate_hz,
                               double seconds) {
  static constexpr std::array<double, 3> kNodes{-0.7745966692414834, 0, 0.7745966692414834};
  static constexpr std::array<double, 3> kWeights{5. / 18, 8. / 18, 5. / 18};
  const double period = 1 / rate_hz;
  const int pieces = rate_hz >= 100 ? 1 : 6;
  std::vector<ImuSample> samples;
  for (std::int64_t k = 0; static_cast<double>(k) < seconds * rate_hz - 0.5; ++k) {
    ImuSample s;
    for (int i = 0; i < 3 * pieces; ++i) {
      const double into = (i / 3 + 0.5 + 0.5 * kNodes[i % 3]) / pieces;
      Vector3d w, f;
      SenseAt(attitude, sensing, period * (static_cast<double>(k) + into), w, f);
      s.w_IT_T += kWeights[i % 3] / pieces * w;
      s.f_T += kWeights[i % 3] / pieces * f;
    }
    s.has_gz = sensing.has_gz;
    s.stamp.period_ns = static_cast<std::int32_t>(std::llround(1e9 * period));
    s.stamp.tool_time.ns = k * s.stamp.period_ns;
    s.stamp.utc.ns = 1'700'000'000'000'000'000 + s.stamp.tool_time.ns;
    s.stamp.seq = k;
    s.stamp.session = 1;
    samples.push_back(s);
  }
  return samples;
}

std::vector<Increment> Increments(const std::vector<ImuSample>& samples, double every,
                                  const IncrementOptions& options) {
  IncrementBuilder builder(options);
  std::vector<Increment> increments;
  const auto fetch = [&] {
    while (builder.Ready()) increments.push_back(builder.Pop());
  };
  double next = every;
  for (const ImuSample& s : samples) {
    builder.Push(s, false);
    const double begin = static_cast<double>(s.stamp.tool_time.ns) * 1e-9,
                 period = s.stamp.period_ns * 1e-9;
    for (; next <= begin + period + 1e-9; next += every) {
      builder.Cut(std::min(1.0, (next - begin) / period));
    }
    fetch();
  }
  builder.Flush();
  fetch();
  return increments;
}

Matrix3d Turned(const Increment& i, double delta) {
  const Eigen::Vector2d turn = i.turn_M + delta * i.turn_per_roll;
  return About(2, i.roll_before + 0.5 * delta) * Exp(Vector3d(turn.x(), turn.y(), 0)) *
         About(2, i.roll_after + 0.5 * delta);
}

Eigen::Vector2d Miss(const Increment& i, const Attitude& attitude, double t, double& delta) {
  const Matrix3d truth =
      InertialAttitude(attitude, t).transpose() * InertialAttitude(attitude, t + i.seconds);
  delta = 0;
  for (int pass = 0; pass < 4; ++pass) delta += Log(Turned(i, delta).transpose() * truth).z();
  return Log(Turned(i, delta).transpose() * truth).head<2>();
}

Resolved AtBegin(const Increment& i, const Attitude& attitude, double begin) {
  double delta = 0;
  Miss(i, attitude, begin, delta);
  const Eigen::Rotation2Dd to_begin(i.roll_before + 0.5 * delta);
  Resolved r{to_begin * (i.turn_M + delta * i.turn_per_roll), i.force_M};
  r.force.head<2>() = to_begin * (i.force_M.head<2>() + delta * i.force_per_roll);
  return r;
}

}  // namespace wellgyro::motion
