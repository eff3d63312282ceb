#include "wellgyro/simulate/truth_well.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/simulate/ellipsoid.h"

namespace wellgyro {
namespace {

// [m]; between nodes, where a cubic stands for the place, an arc of 10 deg/30 m (1 / 172 m) is off
// by h^4 / (384 172^3 m^3) = 3e-11 m.
constexpr double kLongestStep = 0.5;
// A quarter period in 20 steps: Runge and Kutta's fourth order, here Simpson's rule, is off by
// (pi / 40)^4 / 2880 = 1.3e-8 of the wave.
constexpr int kStepsPerDetail = 20;
// As of a job's latitude_deg: 11 km from the pole.
constexpr double kLargestLatitude = FromDegrees(89.9);

enum Index { kNorthing, kEasting, kTvd, kLatitude, kLongitude, kConvergence };

}  // namespace

TruthWell::TruthWell(const SimulatedWell& well, const SimulatedEarth& earth)
    : shape_(well), earth_(earth) {
  if (!(std::abs(earth.latitude) <= kLargestLatitude)) {
    throw std::invalid_argument(fmt::format(
        "[earth] latitude_deg: {}: the meridian is lost at the poles", ToDegrees(earth.latitude)));
  }
  // From W's origin to where the well begins: short enough for the radii of the origin.
  const double s = std::sin(earth.latitude);
  const EllipsoidPlace origin = EllipsoidAt(s, earth.height);
  const Eigen::Vector3d& p = well.begin_p_WT_W;
  State begin;
  begin.head<3>() = p;
  begin[kLatitude] = earth.latitude + p.x() / origin.radius_north;
  begin[kConvergence] = p.y() * std::tan(earth.latitude) / origin.radius_east;
  begin[kLongitude] = earth.longitude + p.y() / (origin.radius_east * std::cos(earth.latitude));
  Integrate(begin);
}

TruthWell::State TruthWell::SlopeAt(double md, const State& state) const {
  const Eigen::Vector3d t = shape_.At(md).tangent_L;
  const double s = std::sin(state[kLatitude]), c = std::cos(state[kLatitude]);
  const EllipsoidPlace place = EllipsoidAt(s, earth_.height - state[kTvd]);
  const double sg = std::sin(state[kConvergence]), cg = std::cos(state[kConvergence]);
  const double longitude = t.y() / (place.radius_east * c);
  State slope;
  slope << t.x() * cg + t.y() * sg, t.y() * cg - t.x() * sg, t.z(), t.x() / place.radius_north,
      longitude, longitude * s;
  return slope;
}

void TruthWell::Integrate(const State& begin) {
  const double length = end_md() - begin_md();
  const double longest = std::min(kLongestStep, shape_.detail() / kStepsPerDetail);
  const auto steps = static_cast<std::size_t>(std::ceil(length / longest));
  step_ = length / static_cast<double>(steps);
  nodes_.reserve(steps + 1);
  nodes_.push_back({begin, SlopeAt(begin_md(), begin)});
  for (std::size_t i = 0; i < steps; ++i) {
    const double md = begin_md() + static_cast<double>(i) * step_;
    const State& y = nodes_[i].value;
    const State& k1 = nodes_[i].slope;
    const State k2 = SlopeAt(md + step_ / 2, y + step_ / 2 * k1);
    const State k3 = SlopeAt(md + step_ / 2, y + step_ / 2 * k2);
    const State k4 = SlopeAt(md + step_, y + step_ * k3);
    const State next = y + step_ / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    nodes_.push_back({next, SlopeAt(md + step_, next)});
  }
}

HolePlace TruthWell::PlaceAt(double md) const {
  const double x =
      std::clamp((md - begin_md()) / step_, 0.0, static_cast<double>(nodes_.size() - 1));
  const std::size_t i = std::min(static_cast<std::size_t>(x), nodes_.size() - 2);
  const double u = x - static_cast<double>(i), v = 1 - u;
  const Node& a = nodes_[i];
  const Node& b = nodes_[i + 1];
  // Cubic Hermite, written so that the step's small change is added to its begin.
  const State change = b.value - a.value;
  const State y =
      a.value + u * u * (3 - 2 * u) * change + step_ * (u * v * v * a.slope - u * u * v * b.slope);
  return {.p_WT_W = y.head<3>(),
          .latitude = y[kLatitude],
          .longitude = y[kLongitude],
          .convergence = y[kConvergence],
          .height_of_w = earth_.height};
}

WellPoint TruthWell::PointAt(double md) const {
  const Eigen::Vector3d t = DirectionAt(md).tangent_L;
  return {.md = md,
          .inclination = std::atan2(std::hypot(t.x(), t.y()), t.z()),
          .azimuth = WrapTwoPi(std::atan2(t.y(), t.x()))};
}

}  // namespace wellgyro
