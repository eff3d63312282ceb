#include "wellgyro/depth/depth_grid.h"

#include <algorithm>
#include <cmath>

namespace wellgyro {
namespace {

// What the two ends of a smooth tenth of a second may disagree by: 10 m/s^2 make 12 mm.
constexpr double kDisagree = 0.05;  // [m]
constexpr double kSeconds = 1e-9 * DepthGrid::kStep.ns;

std::int64_t CellOf(UtcTime utc) {
  const std::int64_t step = DepthGrid::kStep.ns;
  const std::int64_t cell = utc.ns / step;
  return cell * step > utc.ns ? cell - 1 : cell;
}

}  // namespace

const AlongHole& DepthGrid::NodeAt(std::int64_t index) {
  Node& node = nodes_[static_cast<std::size_t>(index & 3)];
  if (node.index != index) node = {index, track_->At(UtcTime{index * kStep.ns})};
  return node.along;
}

AlongHole DepthGrid::At(UtcTime utc) {
  const std::int64_t cell = CellOf(utc);
  const UtcTime begin{cell * kStep.ns};
  if (cell != cell_) {
    a_ = NodeAt(cell);
    b_ = NodeAt(cell + 1);
    cell_ = cell;
    const double way = 0.5 * kSeconds * (a_.speed + b_.speed);
    smooth_ = a_.known && b_.known && std::abs(b_.md - a_.md - way) < kDisagree &&
              track_->Segment(begin) == track_->Segment(begin + kStep);
  }
  if (!smooth_) return a_.known || b_.known ? track_->At(utc) : AlongHole{};
  // Each end's own quadratic, carried to the instant. A track's speed is that of a fit over seconds
  // and not the slope of its depths, so that no cubic goes through both.
  const double dt = static_cast<double>((utc - begin).ns) * 1e-9;
  const double u = dt * (1 / kSeconds);
  const double v = 1 - u;
  const double to = dt - kSeconds;
  AlongHole along;
  along.md = v * (a_.md + dt * (a_.speed + 0.5 * dt * a_.acceleration)) +
             u * (b_.md + to * (b_.speed + 0.5 * to * b_.acceleration));
  along.speed = v * (a_.speed + dt * a_.acceleration) + u * (b_.speed + to * b_.acceleration);
  along.acceleration = v * a_.acceleration + u * b_.acceleration;
  const auto [low, high] = std::minmax(a_.md, b_.md);
  along.md = std::clamp(along.md, low, high);
  along.sigma_md = v * a_.sigma_md + u * b_.sigma_md;
  along.sigma_speed = v * a_.sigma_speed + u * b_.sigma_speed;
  along.sigma_acceleration = v * a_.sigma_acceleration + u * b_.sigma_acceleration;
  along.known = true;
  return along;
}

}  // namespace wellgyro
