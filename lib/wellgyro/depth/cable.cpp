#include "wellgyro/depth/cable.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace wellgyro {
namespace {

// Of a correction by depth, carried on from the last mark: 2 m in 1 km. Wheels are off by 1e-3 of
// the way, as practice allows, and twice that is still one; more is a mark misread.
constexpr double kSlopeMost = 2e-3;
// Of a spacing: at half of it a mark may be either of two, and half of that is left for the
// counter.
constexpr double kFarOff = 0.25;

}  // namespace

double StretchOf(const Cable& cable, double md, std::optional<double> tension) {
  const double length = std::max(md, 0.0);
  const double pull = tension.value_or(cable.tool_weight + cable.weight * length);
  const double mean = 0.5 * (pull + cable.tool_weight);
  const double warmth = cable.surface_temperature + 0.5 * cable.gradient * length;
  return length * (cable.stretch * (mean - cable.measuring_tension) +
                   cable.expansion * (warmth - cable.measuring_temperature));
}

DepthMark Stretched(const Cable& cable, DepthMark mark) {
  if (mark.corrected || !std::isfinite(mark.md)) return mark;
  if (mark.tension && !std::isfinite(*mark.tension)) mark.tension.reset();
  const double stretch = StretchOf(cable, mark.md, mark.tension);
  if (stretch == 0) return mark;
  mark.md += stretch;
  mark.sigma = std::hypot(mark.sigma.value_or(0), cable.ratio_sigma * stretch);
  mark.corrected = true;
  return mark;
}

CableMarks::CableMarks(const Cable& cable, const DepthTrack& track)
    : cable_(cable), track_(&track) {
  if (!(cable.mark_spacing >= 0)) {
    throw std::invalid_argument("CableMarks: mark_spacing must not be negative");
  }
  if (!(cable.sigma_mark >= 0)) {
    throw std::invalid_argument("CableMarks: sigma_mark must not be negative");
  }
}

void CableMarks::Push(const DepthMark& mark) {
  if (!mark.magnetic_mark || cable_.mark_spacing <= 0) return;
  const auto at = std::ranges::lower_bound(waiting_, mark.utc);
  const bool seen =
      (at != waiting_.end() && *at == mark.utc) || (!laws_.empty() && mark.utc <= laws_.back().utc);
  if (!seen) waiting_.insert(at, mark.utc);
}

double CableMarks::Law::At(double md_now, double half) const {
  const double way = md_now - md;
  const double in = std::min(std::abs(way) / half, 1.0);
  return start + in * (target - start) + slope * way;
}

void CableMarks::Take(UtcTime utc) {
  const AlongHole along = track_->At(utc);
  if (!along.known) return;
  const std::int32_t segment = track_->Segment(utc);
  const bool anew = segment_ && *segment_ != segment;
  if (!base_ || (anew && !cable_.first_mark)) base_ = cable_.first_mark.value_or(along.md);
  segment_ = segment;
  const double spacing = cable_.mark_spacing;
  const double place = *base_ + std::round((along.md - *base_) / spacing) * spacing;
  Law law{.utc = utc,
          .segment = segment,
          .md = along.md,
          .start = 0,
          .target = place - along.md,
          .slope = 0};
  if (std::abs(law.target) > kFarOff * spacing) {
    ++left_out_;
    return;
  }
  if (!laws_.empty() && laws_.back().segment == segment) {
    const Law& before = laws_.back();
    law.start = before.At(along.md, 0.5 * spacing);
    const double way = along.md - before.md, change = law.target - before.target;
    if (std::abs(way) > 0.5 * spacing) {
      law.slope = std::clamp(change / way, -kSlopeMost, kSlopeMost);
    }
    largest_change_ = std::max(largest_change_, std::abs(change));
  }
  laws_.push_back(law);
}

void CableMarks::Resolve(UtcTime until) {
  const auto end = std::ranges::upper_bound(waiting_, until);
  for (auto mark = waiting_.begin(); mark != end; ++mark) Take(*mark);
  waiting_.erase(waiting_.begin(), end);
}

double CableMarks::Added(UtcTime utc, double md) {
  Resolve(utc);
  const auto after = std::ranges::upper_bound(laws_, utc, {}, &Law::utc);
  if (after == laws_.begin()) return 0;
  const Law& law = *std::prev(after);
  return law.segment == track_->Segment(utc) ? law.At(md, 0.5 * cable_.mark_spacing) : 0;
}

}  // namespace wellgyro
