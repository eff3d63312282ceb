#include "wellgyro/estimate/hidden_roll.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

// Knots to each side, and of them that tell: the median of five is right with two wrong.
constexpr std::size_t kReach = 60, kLeast = 5;

// Where a bend begins or ends the rate across turns in L with it, and its size changes: by more
// than a tenth, three sigmas of noise apart, from some knots before to as many after.
// With 10 knots the estimate on the way of a clean well that kicks off at 2 rpm is lost: a stop is
// 18.6 sigmas off it. With 2, and with half or twice the others, its end moves by 0.001 sigma.
constexpr std::size_t kAcross = 5;
constexpr double kSteady = 0.1, kChance = 3;

bool Reads(const RunKnot& knot, double horizontal) {
  const Increment& i = knot.increment;
  const double ratio = i.turn_M.norm() / (horizontal * i.seconds);
  return RollIsHidden(knot) && ratio > kEarthsLeast;
}

/// The roll rate against the Earth from one knot's middle to the next one's [rad/s].
double RollBetween(const Increment& a, const Increment& b) {
  const Eigen::Vector2d &u = a.turn_M, &v = b.turn_M;
  const double turned = -std::atan2(v.y() * u.x() - v.x() * u.y(), v.dot(u));
  const double psi = a.roll_after + b.roll_before;
  return (psi + WrapPi(turned - psi)) / (0.5 * (a.seconds + b.seconds));
}

}  // namespace

bool RollIsHidden(const RunKnot& knot) { return !knot.increment.roll_seen && !knot.still; }

bool AnyRollIsHidden(std::span<const RunKnot> knots) {
  return std::any_of(knots.begin(), knots.end(), RollIsHidden);
}

std::vector<bool> SteadyAcross(std::span<const RunKnot> knots, double angle_random_walk) {
  std::vector<double> turns{0}, times{0};
  for (const RunKnot& knot : knots) {
    turns.push_back(turns.back() + knot.increment.turn_M.norm());
    times.push_back(times.back() + knot.increment.seconds);
  }
  std::vector<bool> steady(knots.size());
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const std::size_t begin = k > kAcross ? k - kAcross : 0;
    const std::size_t end = std::min(k + 1 + kAcross, knots.size());
    const double before = std::max(times[k + 1] - times[begin], 1e-9);
    const double after = std::max(times[end] - times[k], 1e-9);
    const double a = (turns[k + 1] - turns[begin]) / before, b = (turns[end] - turns[k]) / after;
    const double chance = kChance * angle_random_walk * std::sqrt(1 / before + 1 / after);
    steady[k] = std::abs(b - a) < 0.5 * kSteady * (a + b) + chance;
  }
  return steady;
}

std::vector<double> HiddenRoll(std::span<const RunKnot> knots, double horizontal,
                               const std::vector<bool>& steady) {
  const auto reads = [&](std::size_t k) { return steady[k] && Reads(knots[k], horizontal); };
  std::vector<double> hidden(knots.size(), 0), near;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    if (!RollIsHidden(knots[k])) continue;
    near.clear();
    // What it did before a stop is not what it does after it.
    std::size_t begin = k, end = k;
    while (begin > 0 && begin + kReach > k && !knots[begin - 1].still) --begin;
    while (end + 1 < knots.size() && end < k + kReach && !knots[end + 1].still) ++end;
    for (std::size_t j = begin; j < end; ++j) {
      if (!reads(j) || !reads(j + 1)) continue;
      near.push_back(RollBetween(knots[j].increment, knots[j + 1].increment));
    }
    if (near.size() < kLeast) continue;
    const auto middle = near.begin() + static_cast<std::ptrdiff_t>(near.size() / 2);
    std::nth_element(near.begin(), middle, near.end());
    const Increment& i = knots[k].increment;
    hidden[k] = *middle - (i.roll_before + i.roll_after) / i.seconds;
  }
  return hidden;
}

}  // namespace wellgyro
