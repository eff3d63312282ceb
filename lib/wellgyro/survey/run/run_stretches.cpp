#include "wellgyro/survey/run/run_stretches.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace wellgyro {
namespace {

RunStretch StretchOf(std::span<const RunKnot> knots) {
  RunStretch s;
  double seconds = 0, known = 0, way = 0;
  for (const RunKnot& knot : knots) {
    const Increment& inc = knot.increment;
    seconds += inc.seconds;
    s.roll_rate += inc.roll();
    s.temperature += inc.seconds * static_cast<double>(knot.temperature);
    s.samples_lost += static_cast<double>(inc.samples_lost);
    if (!knot.along.known) continue;
    known += inc.seconds;
    way += inc.seconds * knot.along.speed;
    s.md = knot.along.md;
  }
  s.end = knots.back().utc;
  s.begin = knots.front().utc - Duration::Seconds(knots.front().increment.seconds);
  if (known > 0) s.speed = way / known;
  s.roll_rate /= seconds;
  s.temperature /= seconds;
  return s;
}

std::optional<double> RmsOf(std::span<const ResidualSum> sums, std::size_t stretch) {
  if (stretch >= sums.size() || !(sums[stretch].count > 0)) return std::nullopt;
  return std::sqrt(sums[stretch].squares / sums[stretch].count);
}

}  // namespace

std::vector<RunStretch> StretchesOf(const Diagnosis& tests, std::span<const RunKnot> knots) {
  std::vector<RunStretch> stretches;
  for (std::size_t begin = 0; begin < knots.size(); begin += kStretchKnots) {
    const std::size_t number = stretches.size();
    const std::size_t count = std::min(kStretchKnots, knots.size() - begin);
    RunStretch& s = stretches.emplace_back(StretchOf(knots.subspan(begin, count)));
    s.residual_gyro = RmsOf(tests.turns, number);
    s.residual_accel = RmsOf(tests.forces, number);
  }
  return stretches;
}

}  // namespace wellgyro
