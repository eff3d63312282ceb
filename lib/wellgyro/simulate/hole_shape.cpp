#include "wellgyro/simulate/hole_shape.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/simulate/smooth_window.h"

namespace wellgyro {
namespace {

constexpr double kLargestBend = FromDegrees(60);  // between stations
constexpr double kStraightUp = FromDegrees(1);

void Require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument(what);
}

}  // namespace

HoleShape::HoleShape(const SimulatedWell& well) {
  if (well.stations.empty()) {
    begin_md_ = well.begin_md;
    end_md_ = well.end_md;
    Require(end_md_ > begin_md_,
            fmt::format("well: end_md {} m is not below begin_md {} m", end_md_, begin_md_));
    detail_ = end_md_ - begin_md_;
    inclination_ = MakeLaw(well.inclination, "inclination");
    azimuth_ = MakeLaw(well.azimuth, "azimuth");
  } else {
    MakeSpline(well.stations);
  }
  // The frame that rolls with kNorth is singular straight up.
  const double step = std::min(detail_ / 4, 5.0);
  const double count = std::ceil((end_md_ - begin_md_) / step);
  for (double k = 0; k <= count; ++k) {
    const double md = std::min(begin_md_ + k * step, end_md_);
    Require(At(md).tangent.z() > -std::cos(kStraightUp),
            fmt::format("well: the hole points straight up at {} m", md));
  }
}

HoleDirection HoleShape::At(double md) const {
  const double inside = std::clamp(md, begin_md_, end_md_);
  if (!knots_.empty()) return OnSpline(inside);
  const Angle inclination = Evaluate(inclination_, inside);
  const Angle azimuth = Evaluate(azimuth_, inside);
  const double si = std::sin(inclination.value), ci = std::cos(inclination.value);
  const double sa = std::sin(azimuth.value), ca = std::cos(azimuth.value);
  return {.tangent = {si * ca, si * sa, ci},
          .curvature = {inclination.slope * ci * ca - azimuth.slope * si * sa,
                        inclination.slope * ci * sa + azimuth.slope * si * ca,
                        -inclination.slope * si}};
}

HoleShape::Law HoleShape::MakeLaw(const AngleLaw& law, const char* name) {
  Law made{.start = law.start, .terms = {}};
  for (std::size_t i = 0; i < law.terms.size(); ++i) {
    const AngleTerm& term = law.terms[i];
    const auto where = fmt::format("well.{}.terms[{}]", name, i);
    const double begin = term.begin_md.value_or(begin_md_);
    const double length = term.end_md.value_or(end_md_) - begin;
    const double ramp_in = term.begin_md ? term.ramp : 0;
    const double ramp_out = term.end_md ? term.ramp : 0;
    Require(
        (!term.begin_md && !term.end_md) || term.ramp > 0,
        fmt::format("{}.ramp {} m is not positive, as a begin or end needs it", where, term.ramp));
    Require(length >= ramp_in + ramp_out && length > 0,
            fmt::format("{}: {} m are too short for ramps of {} m", where, length, term.ramp));
    Require(term.amplitude == 0 || term.period > 0,
            fmt::format("{}.period {} m is not positive", where, term.period));
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

void HoleShape::MakeSpline(const std::vector<WellPoint>& stations) {
  const std::size_t n = stations.size();
  Require(n >= 2, "well.stations: one station makes no hole");
  begin_md_ = stations.front().md;
  end_md_ = stations.back().md;
  detail_ = end_md_ - begin_md_;
  for (std::size_t i = 0; i < n; ++i) {
    const WellPoint& station = stations[i];
    knots_.push_back({.md = station.md,
                      .value = Tangent(station.inclination, station.azimuth),
                      .bend = Eigen::Vector3d::Zero()});
    if (i == 0) continue;
    const double length = station.md - stations[i - 1].md;
    Require(length > 0,
            fmt::format("well.stations[{}].md {} m is not below the one before", i, station.md));
    Require(knots_[i].value.dot(knots_[i - 1].value) > std::cos(kLargestBend),
            fmt::format("well.stations[{}]: more than 60 deg from the station before", i));
    detail_ = std::min(detail_, length);
  }
  // Natural cubic spline: second derivatives by elimination of the tridiagonal system.
  std::vector<double> upper(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = knots_[i].md - knots_[i - 1].md;
    const double after = knots_[i + 1].md - knots_[i].md;
    const Eigen::Vector3d turn = (knots_[i + 1].value - knots_[i].value) / after -
                                 (knots_[i].value - knots_[i - 1].value) / before;
    const double pivot = 2 * (before + after) - before * upper[i - 1];
    upper[i] = after / pivot;
    knots_[i].bend = (6 * turn - before * knots_[i - 1].bend) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) knots_[i].bend -= upper[i] * knots_[i + 1].bend;
}

HoleDirection HoleShape::OnSpline(double md) const {
  const auto after = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, md,
                                      [](double depth, const Knot& k) { return depth < k.md; });
  const Knot& b = *after;
  const Knot& a = *(after - 1);
  const double h = b.md - a.md;
  const double u = (md - a.md) / h, v = 1 - u;
  const Eigen::Vector3d value = v * a.value + u * b.value +
                                (h * h / 6) * ((v * v * v - v) * a.bend + (u * u * u - u) * b.bend);
  const Eigen::Vector3d slope =
      (b.value - a.value) / h + (h / 6) * ((1 - 3 * v * v) * a.bend + (3 * u * u - 1) * b.bend);
  const double length = value.norm();
  const Eigen::Vector3d tangent = value / length;
  return {.tangent = tangent, .curvature = (slope - tangent * tangent.dot(slope)) / length};
}

}  // namespace wellgyro
