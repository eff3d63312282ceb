#include "crossing.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <utility>

#include <Eigen/Geometry>

#include "wellgyro/math/random.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/math/so3.h"

namespace wellgyro::test {
namespace {

using Complex = std::complex<double>;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kDeg = M_PI / 180;
constexpr double kRadius = 6.371e6;
constexpr Complex kI{0, 1};

Complex Across(const Vector3d& v) { return {v.x(), v.y()}; }
Eigen::Vector2d Pair(Complex z) { return {z.real(), z.imag()}; }

constexpr double kPhaseSeconds = 2;  // between the values of a phase that wanders

/// Angle and rate, of full speed 1, of a roll that begins at rest and takes `up` to its speed.
Crossing::Spin FromRest(double t, double up) {
  return t < up ? Crossing::Spin{t * t / (2 * up), t / up} : Crossing::Spin{t - up / 2, 1};
}

/// The same of a roll that is on for `pause` and off for `pause`, begun and ended within 3 s.
Crossing::Spin ByTurns(double t, double pause) {
  constexpr double up = 3;
  const double whole = std::floor(t / (2 * pause)), in = t - 2 * pause * whole;
  const Crossing::Spin on = FromRest(in, up);
  const Crossing::Spin off = in < pause ? Crossing::Spin{} : FromRest(in - pause, up);
  return {whole * pause + on.angle - off.angle, on.rate - off.rate};
}

/// Through values every two seconds a cubic in each with the slope of its neighbours (Catmull and
/// Rom 1974).
Crossing::Spin PhaseAt(const std::vector<double>& p, double t) {
  const double s = t / kPhaseSeconds;
  const auto i = std::min(static_cast<std::size_t>(s), p.size() - 3);
  const double u = s - static_cast<double>(i), before = i > 0 ? p[i - 1] : p[i];
  const double m0 = (p[i + 1] - before) / 2, m1 = (p[i + 2] - p[i]) / 2, d = p[i + 1] - p[i];
  const double c2 = 3 * d - 2 * m0 - m1, c3 = m0 + m1 - 2 * d;
  return {p[i] + u * (m0 + u * (c2 + u * c3)), (m0 + u * (2 * c2 + 3 * u * c3)) / kPhaseSeconds};
}

}  // namespace

void Crossing::DrawPhase(std::uint64_t seed) {
  Random random(seed);
  phase.assign(1, 0);
  while ((static_cast<double>(phase.size()) - 3) * kPhaseSeconds < seconds) {
    phase.push_back(phase.back() + roll.phase_walk * std::sqrt(kPhaseSeconds) * random.Normal());
  }
}

Crossing::Spin Crossing::SpinAt(double t) const {
  const double full = roll.rpm * 2 * M_PI / 60, omega = 2 * M_PI / roll.swing_period;
  const double a = roll.swing_deg * kDeg;
  const Spin by_turns = roll.pause > 0 ? ByTurns(t, roll.pause) : FromRest(t, 30);
  const Spin more = phase.empty() ? Spin{} : PhaseAt(phase, t);
  const double at = omega * t + more.angle;
  return {full * by_turns.angle + a * std::sin(at),
          full * by_turns.rate + a * (omega + more.rate) * std::cos(at)};
}

Crossing::Motion Crossing::At(double t) const {
  const Matrix3d C = RotationZ(0.6) * RotationX(-closest_deg * kDeg);
  const Vector3d y = C.col(1);
  const double rate = 12 * kDeg / seconds;
  const auto [spin, spin_rate] = SpinAt(t);
  Motion m;
  m.R_LT = Exp(rate * (t - seconds / 2) * y) * C * RotationZ(spin);
  const Vector3d tangent = m.R_LT.col(2), v = speed * tangent;
  const double lat = latitude_deg * kDeg;
  const Vector3d earth = 7.292115e-5 * Vector3d(std::cos(lat), 0, -std::sin(lat));
  const Vector3d transport(v.y() / kRadius, -v.x() / kRadius, -v.y() * std::tan(lat) / kRadius);
  const Vector3d w = rate * y + spin_rate * tangent + earth + transport;
  // Below ground gravity grows by the free-air gradient less two Bouguer plates of 2670 kg/m^3.
  const double g = gravity + 0.85e-6 * speed * t;
  const Vector3d f = rate * y.cross(v) + (2 * earth + transport).cross(v) - g * Vector3d::UnitZ();
  m.w_IT_T = m.R_LT.transpose() * w;
  m.f_T = m.R_LT.transpose() * f;
  return m;
}

Crossing::Samples Crossing::Sample(double hz) const {
  Samples s;
  s.hz = hz;
  const double dt = 1 / hz, x = std::sqrt(0.6);
  for (int j = 0; j < std::lround(seconds * hz); ++j) {
    Vector3d w = Vector3d::Zero(), f = w;
    for (const auto& [at, weight] : {std::pair{-x, 5. / 18}, {0., 8. / 18}, {x, 5. / 18}}) {
      const Motion m = At((j + 0.5 * (1 + at)) * dt);
      w += weight * m.w_IT_T;
      f += weight * m.f_T;
    }
    s.w.push_back(w);
    s.f.push_back(f);
  }
  return s;
}

void AddErrors(const ToolDraw& draw, std::uint64_t seed, Crossing::Samples& samples) {
  Random random(seed);
  const auto normal3 = [&random] {
    return Vector3d{random.Normal(), random.Normal(), random.Normal()};
  };
  const Vector3d bias = draw.bias * normal3(), accel_bias = draw.accel_bias * normal3();
  const double root = std::sqrt(samples.hz);
  for (std::size_t j = 0; j < samples.w.size(); ++j) {
    samples.w[j] += bias + draw.arw * root * normal3();
    samples.f[j] += accel_bias + draw.accel_noise * root * normal3();
  }
}

std::vector<double> TrueRoll(const Crossing& crossing, double hz) {
  const auto n = static_cast<int>(std::lround(crossing.seconds * hz));
  std::vector<double> psi{0};
  const double dt = 1 / hz, x = std::sqrt(0.6);
  for (int j = 0; j < n; ++j) {
    double sum = 0;
    for (const auto& [at, weight] : {std::pair{-x, 5. / 18}, {0., 8. / 18}, {x, 5. / 18}}) {
      sum += weight * crossing.At((j + 0.5 * (1 + at)) * dt).w_IT_T.z();
    }
    psi.push_back(psi.back() + sum * dt);
  }
  return psi;
}

/// The means `W` of de-rolled rates with the term of third order, psi at the samples' begins.
std::vector<Complex> ThirdOrder(const std::vector<Complex>& W, const std::vector<double>& psi,
                                std::size_t first) {
  const std::size_t per = W.size();
  std::vector<Complex> third(per);
  for (std::size_t j = 0; j < per; ++j) {
    const Complex a = W[j > 0 ? j - 1 : j], b = W[j + 1 < per ? j + 1 : j];
    const double way = (j > 0) + (j + 1 < per);
    third[j] = W[j] + kI * (psi[first + j + 1] - psi[first + j]) * (b - a) / (12 * way);
  }
  return third;
}

/// Turns the mean of a sensor that turns with psi over a sample to psi = `middle`, de-averaged.
struct Unrolled {
  Complex operator()(std::size_t j) const {
    const double d = psi[j + 1] - psi[j];
    const double sinc = d == 0 ? 1 : std::sin(d / 2) / (d / 2);
    return std::exp(kI * (0.5 * (psi[j] + psi[j + 1]) - middle)) / sinc;
  }
  const std::vector<double>& psi;
  double middle;
};

/// The knot of the `per` samples from `first` on.
RunKnot ReferenceKnot(const Crossing::Samples& s, const std::vector<double>& psi, std::size_t first,
                      std::size_t per) {
  const double dt = 1 / s.hz;
  RunKnot knot;
  Increment& inc = knot.increment;
  inc.seconds = static_cast<double>(per) * dt;
  inc.time.ns = std::llround(static_cast<double>(first + per) * dt * 1e9);
  const double middle = 0.5 * (psi[first + (per - 1) / 2 + (per % 2 ? 0 : 1)] +
                               psi[first + per / 2 + (per % 2 ? 1 : 0)]);
  inc.roll_before = middle - psi[first];
  inc.roll_after = psi[first + per] - middle;
  const Unrolled unrolled{psi, middle};
  std::vector<Complex> W(per), F(per);
  for (std::size_t j = 0; j < per; ++j) {
    W[j] = Across(s.w[first + j]) * unrolled(first + j);
    F[j] = Across(s.f[first + j]) * unrolled(first + j);
  }
  W = ThirdOrder(W, psi, first);
  Complex m = 0, before = 0, dm = 0, df = 0;
  for (std::size_t j = 0; j < per; ++j) {
    m += W[j] * dt;
    const double share = j < per / 2 ? 1 : (per % 2 && j == per / 2 ? 0.5 : 0);
    before += share * W[j] * dt;
  }
  Complex theta = -before;
  Vector3d force = Vector3d::Zero();
  auto& J = inc.turn_by_error;
  const auto n = static_cast<double>(per);
  for (std::size_t j = 0; j < per; ++j) {
    const Complex c = unrolled(first + j), at = theta + 0.5 * W[j] * dt;
    const double fz = s.f[first + j].z();
    const double u = (static_cast<double>(j) + 0.5 - n / 2) / n;
    const double rate = (psi[first + j + 1] - psi[first + j]) / dt;
    const Complex turned = F[j] - kI * at * fz;
    force += Vector3d(turned.real(), turned.imag(), fz + (std::conj(at) * F[j]).imag()) / n;
    dm += kI * W[j] * u * dt;
    df += kI * F[j] * u / n;
    J.col(kGyroBiasX) += Pair(c * dt);
    J.col(kGyroBiasY) += Pair(kI * c * dt);
    J.col(kMassUnbalance) += Pair(F[j] * dt);
    J.col(kQuadrature) += Pair(-kI * F[j] * dt);
    J.col(kGyroScaleX) += Pair(c * s.w[first + j].x() * dt);
    J.col(kGyroScaleY) += Pair(kI * c * s.w[first + j].y() * dt);
    J.col(kMisalignmentX) += Pair(c * rate * dt);
    J.col(kMisalignmentY) += Pair(kI * c * rate * dt);
    J.col(kTimeSkew) += Pair(kI * W[j] * rate * dt);
    inc.ForceBy(kAccelBiasX).head<2>() += Pair(c / n);
    inc.ForceBy(kAccelBiasY).head<2>() += Pair(kI * c / n);
    theta += W[j] * dt;
  }
  inc.ForceBy(kAccelBiasZ).z() = 1;
  J.col(kToolfaceOffset) = Pair(kI * m);
  inc.turn_M = Pair(m);
  inc.turn_before_M = Pair(before);
  inc.force_M = force;
  inc.turn_per_roll = Pair(dm);
  inc.force_per_roll = Pair(df);
  return knot;
}

std::vector<RunKnot> ReferenceKnots(const Crossing::Samples& s, const std::vector<double>& psi,
                                    double seconds, double speed) {
  const auto per = static_cast<std::size_t>(std::lround(seconds * s.hz));
  std::vector<RunKnot> knots;
  for (std::size_t first = 0; first + per <= s.w.size(); first += per) {
    AlongHole& along = knots.emplace_back(ReferenceKnot(s, psi, first, per)).along;
    along.known = true;
    along.md = speed * static_cast<double>(first + per) / s.hz;
    along.speed = speed;
    along.sigma_md = 0.003;
  }
  return knots;
}

}  // namespace wellgyro::test
