#include "attitude/filter_truth.h"

#include <cmath>

#include <Eigen/Dense>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro::filter_truth {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kOmega = 7.292115e-5;

// One drawing of all errors of a tool, and their way through time.
struct Errors {
  Errors(const FilterSetup& s, std::uint64_t seed) : setup(s), random(seed), on(seed != 0) {
    const ErrorPriors& e = s.errors;
    for (int axis = 0; axis < 2; ++axis) {
      level[axis] = Draw(e.gyro_bias_sigma);
      const bool markov_on = s.gyro.bias_instability_correlation_time.has_value();
      if (!markov_on) level[axis] += Draw(s.gyro.bias_instability);
      markov[axis] = markov_on ? Draw(1.076 * s.gyro.bias_instability) : 0;
      ramp[axis] = Draw(s.gyro.rate_ramp);
      scale[axis] = Draw(e.gyro_scale_sigma);
    }
    m = Draw(e.mass_unbalance_sigma);
    q = Draw(e.quadrature_sigma);
    for (int i = 0; i < 3; ++i) accel[i] = Draw(e.accel_bias_sigma);
    latitude = Draw(e.latitude_sigma);
  }

  double Draw(double sigma) { return on && sigma > 0 ? sigma * random.Normal() : 0; }

  void Age(double h) {
    for (int axis = 0; axis < 2; ++axis) {
      level[axis] += ramp[axis] * h + Draw(setup.gyro.rate_random_walk) * std::sqrt(h);
      if (!setup.gyro.bias_instability_correlation_time) continue;
      const double decay = std::exp(-h / *setup.gyro.bias_instability_correlation_time);
      markov[axis] = markov[axis] * decay +
                     Draw(1.076 * setup.gyro.bias_instability) * std::sqrt(1 - decay * decay);
    }
  }

  FilterSetup setup;
  Random random;
  bool on;
  double level[2], markov[2], ramp[2], scale[2], m = 0, q = 0, latitude = 0;
  Vector3d accel = Vector3d::Zero();
};

// Rate of T in inertial space, in T, from the matrices a moment before and after.
Vector3d RateAt(const Motion& motion, double t, double latitude, const Site& site) {
  constexpr double kH = 2e-3;
  const auto attitude = [&](double u) {
    const Pose p = motion(u);
    return AttitudeMatrix(p.azimuth, p.inclination, p.toolface);
  };
  const Matrix3d r = attitude(t);
  // Fourth-order difference.
  const Matrix3d d =
      (8 * (attitude(t + kH) - attitude(t - kH)) - (attitude(t + 2 * kH) - attitude(t - 2 * kH))) /
      (12 * kH);
  const Matrix3d w = r.transpose() * d;
  const double speed = (motion(t + kH).md - motion(t - kH).md) / (2 * kH);
  const Vector3d v = speed * r.col(2);
  const Vector3d level(
      kOmega * std::cos(latitude) + v.y() / site.radius_east, -v.x() / site.radius_north,
      -kOmega * std::sin(latitude) - v.y() * std::tan(latitude) / site.radius_east);
  return Vector3d(w(2, 1), w(0, 2), w(1, 0)) + r.transpose() * level;
}

// Adds one step of length h, sensed at the pose p with rate w.
void AddStep(const Pose& p, const Vector3d& w_true, double h, double g, Errors* e, Knot* k) {
  const Vector3d f_true =
      -AttitudeMatrix(p.azimuth, p.inclination, p.toolface).transpose() * Vector3d(0, 0, g);
  const Vector3d f = f_true + e->accel;
  const double tf = std::atan2(-f.y(), f.x());
  const double inc = std::atan2(std::hypot(f.x(), f.y()), -f.z());
  const double n = e->setup.gyro.angle_random_walk / std::sqrt(h);
  const double wx = w_true.x() * (1 + e->scale[0]) + e->level[0] + e->markov[0] +
                    e->m * f_true.x() + e->q * f_true.y() + e->Draw(n);
  const double wy = w_true.y() * (1 + e->scale[1]) + e->level[1] + e->markov[1] +
                    e->m * f_true.y() - e->q * f_true.x() + e->Draw(n);
  e->Age(h);
  const double c = std::cos(tf), s = std::sin(tf), si = std::sin(inc), ci = std::cos(inc);
  const double wh = wx * c - wy * s, wr = wx * s + wy * c;
  k->turn += -wh / si * h;
  k->lift += wr * h;
  k->cot += ci / si * h;
  k->white_turn += h / (si * si);
  const auto source = [&](Knot::Source i, double dh, double dr) {
    k->d_turn[i] += -dh / si * h;
    k->d_lift[i] += dr * h;
  };
  source(Knot::kGyroBiasX, c, s);
  source(Knot::kGyroBiasY, -s, c);
  source(Knot::kMassUnbalance, g * si, 0);
  source(Knot::kQuadrature, 0, -g * si);
  source(Knot::kGyroScaleX, wx * c, wx * s);
  source(Knot::kGyroScaleY, -wy * s, wy * c);
  const double d_tf[3] = {-s / (g * si), -c / (g * si), 0};
  const double d_inc[3] = {ci * c / g, -ci * s / g, si / g};
  for (int i = 0; i < 3; ++i) {
    const auto at = Knot::kAccelBiasX + i;
    k->d_turn[at] += (wr * d_tf[i] / si + wh * ci / (si * si) * d_inc[i]) * h;
    k->d_lift[at] += wh * d_tf[i] * h;
    k->d_inclination[at] = d_inc[i];
  }
  k->inclination = inc;
  k->toolface = tf;
}

}  // namespace

FilterSetup SetupAt(double latitude) {
  FilterSetup setup;
  setup.site = SiteAt(latitude, 0);
  return setup;
}

Truth MakeKnots(const Plan& plan, const FilterSetup& setup, std::uint64_t seed) {
  Truth truth;
  truth.start = plan.motion(0);
  Errors errors(setup, seed);
  double latitude = setup.site.latitude + errors.latitude;
  const int n = plan.steps_per_knot;
  const double h = plan.knot_seconds / n;
  const double g = setup.site.gravity;
  const auto count = static_cast<std::int64_t>(std::llround(plan.seconds / plan.knot_seconds));
  for (std::int64_t k = 0; k < count; ++k) {
    const double begin = static_cast<double>(k) * plan.knot_seconds;
    Knot knot;
    knot.still = plan.still(begin + plan.knot_seconds / 2);
    knot.seconds = plan.knot_seconds;
    for (int i = 0; i < n; ++i) {
      const double t = begin + (i + 0.5) * h;
      const Pose p = plan.motion(t);
      AddStep(p, RateAt(plan.motion, t, latitude, setup.site), h, g, &errors, &knot);
      const double along = plan.motion(t + h / 2).md - plan.motion(t - h / 2).md;
      latitude += along * std::sin(p.inclination) * std::cos(p.azimuth) / setup.site.radius_north;
    }
    const double end = begin + plan.knot_seconds;
    const Pose p = plan.motion(end);
    // Angles at the very end, the tool's own accelerometers still in error.
    Knot last;
    AddStep(p, Vector3d::Zero(), 0, g, &errors, &last);
    knot.inclination = last.inclination;
    knot.toolface = last.toolface;
    knot.d_inclination = last.d_inclination;
    knot.time = ToolTime{std::llround(end * 1e9)};
    knot.along = {.md = p.md, .known = true};
    truth.knots.push_back(knot);
    truth.poses.push_back(p);
  }
  return truth;
}

NorthFix FixOf(const std::vector<Knot>& knots, std::size_t begin, std::size_t end,
               const FilterSetup& setup, double near) {
  double turn = 0, lift = 0, cot = 0, seconds = 0;
  for (std::size_t i = begin; i < end; ++i) {
    turn += knots[i].turn;
    lift += knots[i].lift;
    cot += knots[i].cot;
    seconds += knots[i].seconds;
  }
  const double sine = 1 / std::hypot(1.0, cot / seconds), cosine = sine * cot / seconds;
  const double north = kOmega * std::cos(setup.site.latitude);
  const double up = kOmega * std::sin(setup.site.latitude);
  double a = near;
  for (int pass = 0; pass < 20; ++pass) {
    const double rh = -turn * sine / seconds - north * std::cos(a) * cosine - up * sine;
    const double rr = lift / seconds + north * std::sin(a);
    const double jh = -north * std::sin(a) * cosine, jr = -north * std::cos(a);
    a += (jh * rh + jr * rr) / (jh * jh + jr * jr);
  }
  NorthFix fix;
  fix.begin = knots[begin].time - Duration::Seconds(knots[begin].seconds);
  fix.end = knots[end - 1].time;
  fix.azimuth = WrapTwoPi(a);
  const double rate = std::hypot(setup.errors.gyro_bias_sigma, setup.gyro.bias_instability,
                                 setup.gyro.angle_random_walk / std::sqrt(seconds));
  const double j = north * std::hypot(std::sin(a) * cosine, std::cos(a));
  fix.cov_attitude(1, 1) = rate * rate / (j * j);
  return fix;
}

NorthFix ExternalFix(const Knot& at, double azimuth, double sigma) {
  NorthFix fix;
  fix.begin = fix.end = at.time;
  fix.external = true;
  fix.azimuth = WrapTwoPi(azimuth);
  fix.cov_attitude(1, 1) = sigma * sigma;
  return fix;
}

}  // namespace wellgyro::filter_truth
