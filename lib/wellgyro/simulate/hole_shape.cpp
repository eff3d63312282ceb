#include "wellgyro/simulate/hole_shape.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/simulate/require_internal.h"
#include "wellgyro/simulate/smooth_window.h"

namespace wellgyro {
namespace {

// Between stations: no hole turns so in a stand, and the spline's great circles stay far from 180
// deg, where they are undetermined.
constexpr double kLargestBend = FromDegrees(60);
// [m], of ramps and quarter periods: shorter than any tool, which does not follow it; the truth is
// integrated by 1 / kStepsPerDetail of it, 5 mm.
constexpr double kLeastDetail = 0.1;
// The frame turns about z by tan(I / 2) times what the hole turns aside: 115 times 1 deg from
// there.
constexpr double kStraightUp = FromDegrees(1);

// The direction `u` of the way from `a` to `b` along their great circle, also beyond either.
Eigen::Vector3d OnArc(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double u) {
  const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
  if (angle < 1e-9) return ((1 - u) * a + u * b).normalized();
  return (std::sin((1 - u) * angle) * a + std::sin(u * angle) * b) / std::sin(angle);
}

}  // namespace

HoleShape::HoleShape(const SimulatedWell& well) {
  if (well.stations.empty()) {
    begin_md_ = well.begin_md;
    end_md_ = well.end_md;
    Require(end_md_ > begin_md_,
            fmt::format("[well] end_md_m: {} is not below begin_md_m, {}", end_md_, begin_md_));
    detail_ = end_md_ - begin_md_;
    inclination_ = MakeLaw(well.inclination, "inclination");
    azimuth_ = MakeLaw(well.azimuth, "azimuth");
    Require(detail_ >= kLeastDetail,
            fmt::format("[well]: ramps and quarter periods go down to {} m, below {} m", detail_,
                        kLeastDetail));
  } else {
    MakeSpline(well);
  }
  // The frame that rolls with kNorth is singular straight up.
  const double step = std::min(detail_ / 4, 5.0);
  const double count = std::ceil((end_md_ - begin_md_) / step);
  for (double k = 0; k <= count; ++k) {
    const double md = std::min(begin_md_ + k * step, end_md_);
    Require(At(md).tangent_L.z() > -std::cos(kStraightUp),
            fmt::format("[well]: the hole points straight up at {} m", md));
  }
}

HoleDirection HoleShape::At(double md) const {
  const double inside = std::clamp(md, begin_md_, end_md_);
  if (!controls_L_.empty()) return OnSpline(inside);
  const Angle inclination = Evaluate(inclination_, inside);
  const Angle azimuth = Evaluate(azimuth_, inside);
  const double si = std::sin(inclination.value), ci = std::cos(inclination.value);
  const double sa = std::sin(azimuth.value), ca = std::cos(azimuth.value);
  return {.tangent_L = {si * ca, si * sa, ci},
          .curvature_L = {inclination.slope * ci * ca - azimuth.slope * si * sa,
                          inclination.slope * ci * sa + azimuth.slope * si * ca,
                          -inclination.slope * si}};
}

HoleShape::Law HoleShape::MakeLaw(const AngleLaw& law, const char* name) {
  Law made{.start = law.start, .terms = {}};
  for (std::size_t i = 0; i < law.terms.size(); ++i) {
    const AngleTerm& term = law.terms[i];
    const auto where = fmt::format("[[well.{}.term]] {}", name, i + 1);
    const double begin = term.begin_md.value_or(begin_md_);
    const double length = term.end_md.value_or(end_md_) - begin;
    const double ramp_in = term.begin_md ? term.ramp : 0;
    const double ramp_out = term.end_md ? term.ramp : 0;
    Require(
        (!term.begin_md && !term.end_md) || term.ramp > 0,
        fmt::format("{}: ramp_m {} is not positive, as a begin or end needs it", where, term.ramp));
    Require(length >= ramp_in + ramp_out && length > 0,
            fmt::format("{}: {} m are too short for ramps of {} m", where, length, term.ramp));
    Require(term.amplitude == 0 || term.period > 0,
            fmt::format("{}: period_m {} is not positive", where, term.period));
    const bool waves = term.amplitude != 0;
    made.terms.push_back({.begin = begin,
                          .length = length,
                          .ramp_in = ramp_in,
                          .ramp_out = ramp_out,
                          .rate = term.rate,
                          .amplitude = term.amplitude,
                          .wave_number = waves ? kTwoPi / term.period : 0,
                          .phase = term.phase});
    if (ramp_in + ramp_out > 0) detail_ = std::min(detail_, term.ramp);
    if (waves) detail_ = std::min(detail_, term.period / 4);
  }
  return made;
}

HoleShape::Angle HoleShape::Evaluate(const Law& law, double md) {
  Angle sum{law.start, 0};
  for (const Term& term : law.terms) {
    const double x = md - term.begin;
    const SmoothWindow w = SmoothWindowAt(x, term.length, term.ramp_in, term.ramp_out);
    sum.value += term.rate * w.integral;
    sum.slope += term.rate * w.value;
    if (term.amplitude == 0 || w.value == 0) continue;
    const double angle = term.wave_number * x + term.phase;
    const double s = std::sin(angle);
    sum.value += term.amplitude * w.value * s;
    sum.slope += term.amplitude * (w.slope * s + w.value * term.wave_number * std::cos(angle));
  }
  return sum;
}

void HoleShape::MakeSpline(const SimulatedWell& well) {
  const std::vector<WellPoint>& stations = well.stations;
  const std::size_t n = stations.size();
  Require(n >= 2, "[well]: one station makes no hole");
  Require(well.smoothing >= kLeastDetail,
          fmt::format("[well] smoothing: {} m is below {} m", well.smoothing, kLeastDetail));
  std::vector<Eigen::Vector3d> tangents;
  for (std::size_t i = 0; i < n; ++i) {
    tangents.push_back(Tangent(stations[i].inclination, stations[i].azimuth));
    if (i == 0) continue;
    Require(stations[i].md > stations[i - 1].md,
            fmt::format("[well]: station {}, at {} m, is not below the one before", i + 1,
                        stations[i].md));
    Require(tangents[i].dot(tangents[i - 1]) > std::cos(kLargestBend),
            fmt::format("[well]: station {} is more than 60 deg from the one before", i + 1));
  }
  begin_md_ = stations.front().md;
  end_md_ = stations.back().md;
  const double length = end_md_ - begin_md_;
  const double knots = std::max(std::ceil(length / well.smoothing), 1.0);
  spacing_ = length / knots;
  detail_ = spacing_;
  // One control point before the begin, one at each knot, one past the end.
  std::size_t leg = 1;
  for (double k = -1; k <= knots + 1; ++k) {
    const double md = begin_md_ + k * spacing_;
    while (leg + 1 < n && md > stations[leg].md) ++leg;
    const double u = (md - stations[leg - 1].md) / (stations[leg].md - stations[leg - 1].md);
    controls_L_.push_back(OnArc(tangents[leg - 1], tangents[leg], u));
  }
}

HoleDirection HoleShape::OnSpline(double md) const {
  const double x = (md - begin_md_) / spacing_;
  const std::size_t i = std::min(static_cast<std::size_t>(x), controls_L_.size() - 4);
  const double u = x - static_cast<double>(i), v = 1 - u;
  const Eigen::Vector3d &a = controls_L_[i], &b = controls_L_[i + 1], &c = controls_L_[i + 2],
                        &d = controls_L_[i + 3];
  // Uniform cubic B-spline.
  const Eigen::Vector3d value = (v * v * v * a + (4 - 3 * u * u * (1 + v)) * b +
                                 (4 - 3 * v * v * (1 + u)) * c + u * u * u * d) /
                                6;
  const Eigen::Vector3d slope =
      (v * v * (b - a) + (1 + 2 * u * v) * (c - b) + u * u * (d - c)) / (2 * spacing_);
  const double length = value.norm();
  const Eigen::Vector3d tangent = value / length;
  return {.tangent_L = tangent, .curvature_L = (slope - tangent * tangent.dot(slope)) / length};
}

}  // namespace wellgyro
