#include "attitude/tracker_truth.h"

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro::truth {

Site SiteOf(double latitude) { return SiteAt(latitude, 0); }

void SenseAt(const Path& path, const Sensors& sensors, const Site& site, double t,
             Eigen::Vector3d& w_IT_T, Eigen::Vector3d& f_T) {
  const Motion m = path(t);
  const double si = std::sin(m.inclination), ci = std::cos(m.inclination);
  const double sa = std::sin(m.azimuth), ca = std::cos(m.azimuth);
  const Eigen::Matrix3d R_LT = AttitudeMatrix(m.azimuth, m.inclination, m.toolface);
  const Eigen::Vector3d tangent(si * ca, si * sa, ci);
  const Eigen::Vector3d tangent_rate(ci * ca * m.inclination_rate - si * sa * m.azimuth_rate,
                                     ci * sa * m.inclination_rate + si * ca * m.azimuth_rate,
                                     -si * m.inclination_rate);
  const Eigen::Vector3d v = m.speed * tangent;
  const double lat = site.latitude;
  const Eigen::Vector3d w_IE(kEarthRate * std::cos(lat), 0, -kEarthRate * std::sin(lat));
  const Eigen::Vector3d w_EL(v.y() / site.radius_east, -v.x() / site.radius_north,
                             -v.y() * std::tan(lat) / site.radius_east);
  // Rz(A) Ry(I) Rz(T) turns about down, then about the level y, then about the axis.
  const Eigen::Vector3d w_LT = Eigen::Vector3d(0, 0, m.azimuth_rate) +
                               m.inclination_rate * Eigen::Vector3d(-sa, ca, 0) +
                               m.toolface_rate * tangent;
  w_IT_T = R_LT.transpose() * (w_IE + w_EL + w_LT);
  const Eigen::Vector3d v_rate = m.acceleration * tangent + m.speed * tangent_rate;
  f_T = R_LT.transpose() *
        (v_rate + (2 * w_IE + w_EL).cross(v) - Eigen::Vector3d(0, 0, site.gravity));
  const Eigen::Vector3d spin(w_IT_T.x(), w_IT_T.y(), w_IT_T.z());
  const Eigen::Vector3d spin_rate(-w_IT_T.z() * -w_IT_T.y(), -w_IT_T.z() * w_IT_T.x(),
                                  m.toolface_acceleration);
  f_T += spin_rate.cross(sensors.p_accel_T) + spin.cross(spin.cross(sensors.p_accel_T));

  const Knot::SourceVector& e = sensors.error;
  const Eigen::Vector3d w = w_IT_T, f = f_T;
  w_IT_T.x() += e(Knot::kGyroBiasX) + e(Knot::kMassUnbalance) * f.x() +
                e(Knot::kQuadrature) * f.y() + e(Knot::kGyroScaleX) * w.x() +
                e(Knot::kMisalignmentX) * w.z();
  w_IT_T.y() += e(Knot::kGyroBiasY) + e(Knot::kMassUnbalance) * f.y() -
                e(Knot::kQuadrature) * f.x() + e(Knot::kGyroScaleY) * w.y() +
                e(Knot::kMisalignmentY) * w.z();
  const double ahead = e(Knot::kToolfaceOffset) + e(Knot::kTimeSkew) * m.toolface_rate;
  f_T = RotationZ(-ahead) * f;
  f_T += Eigen::Vector3d(e(Knot::kAccelBiasX), e(Knot::kAccelBiasY), e(Knot::kAccelBiasZ));
}

ImuSample SampleAt(const Path& path, const Sensors& sensors, const Site& site, std::int64_t k,
                   double rate) {
  static constexpr std::array<double, 3> kNodes{-0.7745966692414834, 0, 0.7745966692414834};
  static constexpr std::array<double, 3> kWeights{5. / 18, 8. / 18, 5. / 18};
  const double period = 1 / rate, begin = static_cast<double>(k) * period;
  const int pieces = rate > 50 ? 1 : rate > 5 ? 3 : 12;
  ImuSample sample;
  for (int i = 0; i < pieces; ++i) {
    for (std::size_t j = 0; j < kNodes.size(); ++j) {
      Eigen::Vector3d w, f;
      SenseAt(path, sensors, site, begin + period * (i + 0.5 + 0.5 * kNodes[j]) / pieces, w, f);
      sample.w_IT_T += kWeights[j] / pieces * w;
      sample.f_T += kWeights[j] / pieces * f;
    }
  }
  sample.has_gz = sensors.has_gz;
  if (!sample.has_gz) sample.w_IT_T.z() = 0;
  sample.stamp.period_ns = static_cast<std::int32_t>(std::llround(1e9 * period));
  sample.stamp.tool_time.ns = k * sample.stamp.period_ns;
  sample.stamp.utc.ns = 1'700'000'000'000'000'000 + sample.stamp.tool_time.ns;
  sample.stamp.seq = k;
  sample.stamp.session = 1;
  return sample;
}

AlongHole AlongAt(const Path& path, double t) {
  const Motion m = path(t);
  return {m.md, m.speed, m.acceleration, 0, true};
}

Path Hour(double inclination_deg) {
  return [i0 = FromDegrees(inclination_deg)](double t) {
    const double wi = kTwoPi / 600, wa = kTwoPi / 3600, wt = kTwoPi / 23;
    const double ai = FromDegrees(1.8), aa = FromDegrees(50), at = FromDegrees(25);
    Motion m;
    m.inclination = i0 + ai * std::sin(wi * t);
    m.inclination_rate = ai * wi * std::cos(wi * t);
    m.azimuth = FromDegrees(70) + aa * std::sin(wa * t);
    m.azimuth_rate = aa * wa * std::cos(wa * t);
    m.toolface = 0.3 + kTwoPi / 20 * t + at * std::sin(wt * t);
    m.toolface_rate = kTwoPi / 20 + at * wt * std::cos(wt * t);
    m.toolface_acceleration = -at * wt * wt * std::sin(wt * t);
    m.md = 100 + 0.6 * t;
    m.speed = 0.6;
    return m;
  };
}

Path Slide(double inclination_deg) {
  return [turning = Hour(inclination_deg)](double t) {
    Motion m = turning(t);
    m.toolface = 0.6 + 0.2 * std::sin(kTwoPi / 300 * t);
    m.toolface_rate = 0.2 * kTwoPi / 300 * std::cos(kTwoPi / 300 * t);
    m.toolface_acceleration = 0;
    return m;
  };
}

std::vector<Knot> Fly(const Path& path, const Flight& flight) {
  HighSideTracker tracker(flight.options);
  std::vector<Knot> knots;
  const auto n = static_cast<std::int64_t>(flight.seconds * flight.rate);
  const auto every = static_cast<std::int64_t>(flight.every * flight.rate);
  for (std::int64_t k = 0; k < n; ++k) {
    const double t = static_cast<double>(k) / flight.rate;
    if (flight.azimuth && k % static_cast<std::int64_t>(flight.rate) == 0)
      tracker.SetAzimuth(path(t).azimuth);
    tracker.Push(SampleAt(path, flight.sensors, flight.site, k, flight.rate), AlongAt(path, t),
                 flight.site);
    if (k > 0 && k % every == 0) knots.push_back(tracker.CutKnot());
  }
  tracker.Flush();
  knots.push_back(tracker.CutKnot());
  return knots;
}

std::vector<double> Propagate(double azimuth, double inclination, const std::vector<Knot>& knots,
                              const Site& site) {
  const double lat = site.latitude;
  const double north = kEarthRate * std::cos(lat), down = kEarthRate * std::sin(lat);
  std::vector<double> azimuths;
  for (const Knot& knot : knots) {
    const double v = knot.along.known ? knot.along.speed : 0;
    const double si = std::sin(0.5 * (inclination + knot.inclination));
    const double ci = std::cos(0.5 * (inclination + knot.inclination));
    double end = azimuth + knot.turn;
    for (int pass = 0; pass < 3; ++pass) {
      const double mid = 0.5 * (azimuth + end), ca = std::cos(mid), sa = std::sin(mid);
      const double carried = v * ca * sa * ci * (1 / site.radius_east - 1 / site.radius_north) +
                             v * si * sa * std::tan(lat) / site.radius_east;
      end = azimuth + knot.turn + north * ca * knot.cot + (down + carried) * knot.seconds;
    }
    azimuth = end;
    inclination = knot.inclination;
    azimuths.push_back(azimuth);
  }
  return azimuths;
}

}  // namespace wellgyro::truth
