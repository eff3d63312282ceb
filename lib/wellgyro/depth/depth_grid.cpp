#include "wellgyro/depth/depth_grid.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace wellgyro {
namespace {

// What the two ends of a smooth tenth of a second may disagree by: 10 m/s^2 make 12 mm. Half and
// twice of it give three clean runs the same bytes.
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

bool DepthGrid::CellIsFinal(UtcTime utc, UtcTime until) {
  const UtcTime begin{CellOf(utc) * kStep.ns};
  const bool final = track_->Knows(begin, until) && track_->Knows(begin + kStep, until);
  if (final) final_ns_ = begin.ns;
  return final;
}

void DepthGrid::Enter(UtcTime utc) {
  const std::int64_t cell = CellOf(utc);
  const UtcTime begin{cell * kStep.ns};
  const AlongHole a = NodeAt(cell), b = NodeAt(cell + 1);
  begin_ns_ = begin.ns;
  known_ = a.known || b.known;
  const double way = 0.5 * kSeconds * (a.speed + b.speed);
  smooth_ = a.known && b.known && std::abs(b.md - a.md - way) < kDisagree &&
            track_->Segment(begin) == track_->Segment(begin + kStep);
  if (smooth_) blend_ = BlendOf(a, b);
}

AlongHole DepthGrid::Asked(UtcTime utc) const { return known_ ? track_->At(utc) : AlongHole{}; }

/// The polynomials of the present cell at some instants in it, which stand from `begin` on.
void DepthGrid::Smooth(std::span<const UtcTime> utc, std::size_t begin, Asks asks,
                       AlongHoleBlock& along) const {
  const auto n = static_cast<Eigen::Index>(utc.size()), at = static_cast<Eigen::Index>(begin);
  AlongHoleBlock::Values seconds;
  // A cell's nanoseconds are less than 2^31, of which two are converted at a time.
  static_assert(kStep.ns < INT32_MAX);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::int64_t since = utc[static_cast<std::size_t>(i)].ns - begin_ns_;
    seconds[i] = static_cast<double>(static_cast<std::int32_t>(since)) * 1e-9;
  }
  const auto t = seconds.head(n);
  const Blend& c = blend_;
  along.md.segment(at, n) =
      (c.md[0] + t * (c.md[1] + t * (c.md[2] + t * c.md[3]))).max(c.md_low).min(c.md_high);
  along.speed.segment(at, n) = c.speed[0] + t * (c.speed[1] + t * c.speed[2]);
  along.sigma_speed.segment(at, n) = c.begin[2] + t * c.slope[2];
  along.known.segment(at, n) = true;
  if (asks == Asks::kSpeed) return;
  along.acceleration.segment(at, n) = c.begin[0] + t * c.slope[0];
  along.sigma_md.segment(at, n) = c.begin[1] + t * c.slope[1];
  along.sigma_acceleration.segment(at, n) = c.begin[3] + t * c.slope[3];
}

void DepthGrid::At(std::span<const UtcTime> utc, Asks asks, AlongHoleBlock& along) {
  for (std::size_t i = 0; i < utc.size();) {
    along.Set(i, At(utc[i]));
    const std::size_t begin = i++;
    if (!smooth_) continue;
    const UtcTime end{begin_ns_ + kStep.ns};
    while (i < utc.size() && utc[begin] <= utc[i] && utc[i] < end) ++i;
    if (i > begin + 1) Smooth(utc.subspan(begin, i - begin), begin, asks, along);
  }
}

/// Each end's own quadratic, carried to the instant, by its nearness. A track's speed is that of a
/// fit over seconds and not the slope of its depths, so that no cubic goes through both.
DepthGrid::Blend DepthGrid::BlendOf(const AlongHole& a, const AlongHole& b) {
  constexpr double h = kSeconds;
  const double bend = 0.5 * a.acceleration;
  // What b's quadratic says more than a's, by powers of the time since a.
  const double d0 = b.md - h * (b.speed - 0.5 * h * b.acceleration) - a.md;
  const double d1 = b.speed - h * b.acceleration - a.speed;
  const double d2 = 0.5 * b.acceleration - bend;
  Blend blend;
  blend.md = {a.md, a.speed + d0 / h, bend + d1 / h, d2 / h};
  blend.speed = {a.speed, a.acceleration + d1 / h, 2 * d2 / h};
  blend.begin = {a.acceleration, a.sigma_md, a.sigma_speed, a.sigma_acceleration};
  blend.slope = {2 * d2 / h, (b.sigma_md - a.sigma_md) / h, (b.sigma_speed - a.sigma_speed) / h,
                 (b.sigma_acceleration - a.sigma_acceleration) / h};
  std::tie(blend.md_low, blend.md_high) = std::minmax(a.md, b.md);
  return blend;
}

}  // namespace wellgyro
