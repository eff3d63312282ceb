#include "wellgyro/estimate/hidden_roll.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

constexpr std::size_t kReach = 10, kLeast = 5;  // knots to each side, and of them that tell
constexpr double kLeastRatio = 0.7;             // of what the gyros read to the Earth's across

bool Reads(const RunKnot& knot, double horizontal) {
  const Increment& i = knot.increment;
  const double ratio = i.turn_M.norm() / (horizontal * i.seconds);
  return !i.roll_seen && !knot.still && ratio > kLeastRatio;
}

/// Of psi against the Earth from one knot's middle to the next one's [rad/s].
std::optional<double> SlipBetween(const RunKnot& a, const RunKnot& b, double horizontal) {
  if (!Reads(a, horizontal) || !Reads(b, horizontal)) return std::nullopt;
  const Eigen::Vector2d& u = a.increment.turn_M;
  const Eigen::Vector2d& v = b.increment.turn_M;
  const double turned = -std::atan2(v.y() * u.x() - v.x() * u.y(), v.dot(u));
  const double angle = WrapPi(turned - (a.increment.roll_after + b.increment.roll_before));
  return angle / (0.5 * (a.increment.seconds + b.increment.seconds));
}

}  // namespace

std::vector<double> HiddenRoll(std::span<const RunKnot> knots, double horizontal) {
  std::vector<double> hidden(knots.size(), 0), near;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    if (knots[k].increment.roll_seen || knots[k].still) continue;
    near.clear();
    const std::size_t begin = k > kReach ? k - kReach : 0;
    const std::size_t end = std::min(k + kReach, knots.size() - 1);
    for (std::size_t j = begin; j < end; ++j) {
      if (const auto slip = SlipBetween(knots[j], knots[j + 1], horizontal)) near.push_back(*slip);
    }
    if (near.size() < kLeast) continue;
    const auto middle = near.begin() + static_cast<std::ptrdiff_t>(near.size() / 2);
    std::nth_element(near.begin(), middle, near.end());
    hidden[k] = *middle;
  }
  return hidden;
}

}  // namespace wellgyro
