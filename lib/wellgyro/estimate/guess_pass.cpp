#include "wellgyro/estimate/guess_pass.h"

#include <cmath>

#include <Eigen/Geometry>

#include "wellgyro/earth/earth_rate.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Gains of a complementary filter: a knot's gravity corrects kTiltShare of the axis' tilt and,
// where it shows the roll, kTurnShare s^2 / (s^2 + kTurnSine2) of the roll, with s = sin I and
// kTurnSine2 = (0.1 deg)^2: nearer to vertical what it shows may be its sensors' bias. They choose
// no solution: halved or doubled, each leads three clean runs to the same one, to 0.001 sigma.
constexpr double kTiltShare = 0.05, kTurnShare = 0.5, kTurnSine2 = 3e-6;

}  // namespace

GuessPass::GuessPass(const EstimateSetup& setup, std::span<const RunKnot> knots,
                     std::span<const double> hidden_roll)
    : latitude_(setup.site.latitude),
      knots_(knots),
      hidden_roll_(hidden_roll),
      extra_roll_(knots.size(), 0),
      nodes_(knots.size() + 1) {}

void GuessPass::Run(std::size_t begin, std::size_t end) {
  const Vector3d earth = EarthRateAt(latitude_);
  for (std::size_t k = begin; k < end; ++k) {
    const Increment& inc = knots_[k].increment;
    const double extra = extra_roll_[k] + hidden_roll_[k] * inc.seconds;
    const Matrix3d half = Exp(0.5 * Flat(inc.turn_M));
    Matrix3d M = Exp(-inc.seconds * earth) * nodes_[k].R_LT *
                 RotationZ(inc.roll_before + 0.5 * extra) * half;
    if (inc.level) {
      const Vector3d f = inc.force_M.normalized();
      const Vector3d p = -M.row(2).transpose();
      const double sine2 = std::hypot(f.x(), f.y()) * std::hypot(p.x(), p.y());
      // The angle about the axis from where the force should be to where it is.
      const double angle = std::atan2(f.y() * p.x() - f.x() * p.y(), f.x() * p.x() + f.y() * p.y());
      const double share = inc.roll_seen ? kTurnShare * sine2 / (sine2 + kTurnSine2) : 0;
      M = M * RotationZ(-share * angle);
      const Vector3d down = -M.row(2).transpose();
      M = M * Exp(kTiltShare * f.cross(down));
    }
    Node& next = nodes_[k + 1];
    next.R_LT = M * half * RotationZ(inc.roll_after + 0.5 * extra);
    nodes_[k].roll_rate = (inc.roll() + extra) / inc.seconds;
    next.roll_rate = nodes_[k].roll_rate;
    next.md = knots_[k].along.known ? knots_[k].along.md : nodes_[k].md;
    next.speed = knots_[k].along.known ? knots_[k].along.speed : 0;
  }
  if (begin > 0) return;
  nodes_[0].md = nodes_[1].md - nodes_[1].speed * knots_[0].increment.seconds;
  nodes_[0].speed = nodes_[1].speed;
}

}  // namespace wellgyro
