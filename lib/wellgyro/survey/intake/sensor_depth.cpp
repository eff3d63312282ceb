#include "wellgyro/survey/intake/sensor_depth.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace wellgyro {
namespace {

double Correction(const std::vector<std::pair<double, double>>& table, double md) {
  if (table.empty()) return 0;
  const auto after = std::upper_bound(table.begin(), table.end(), md,
                                      [](double x, const auto& row) { return x < row.first; });
  if (after == table.begin()) return table.front().second;
  if (after == table.end()) return table.back().second;
  const auto& [x1, y1] = *after;
  const auto& [x0, y0] = *std::prev(after);
  return y0 + (md - x0) / (x1 - x0) * (y1 - y0);
}

}  // namespace

SensorDepth::SensorDepth(const Job& job, const DepthTrack& track, CableMarks& marks)
    : corrections_(job.depth.corrections),
      marks_(marks),
      grid_(track),
      corrects_(!job.depth.corrections.empty() || job.depth.cable.mark_spacing > 0),
      sensor_below_reference_(job.string.sensor_below_reference) {}

bool SensorDepth::Knows(UtcTime utc, Duration period, UtcTime until) {
  const UtcTime middle = utc + Duration{period.ns / 2};
  return grid_.Knows(utc, until) && grid_.Knows(middle, until);
}

void SensorDepth::ShiftToSensor(UtcTime utc, double doubt, AlongHole& along) const {
  if (!along.known) return;
  double below = sensor_below_reference_;
  if (corrects_) {
    along.md += marks_.At(utc, along.md);
    below += Correction(corrections_, along.md);
  }
  along.md += below;
  // What the string moved in the time by which UTC may be wrong.
  if (doubt > 0) along.sigma_md = std::hypot(along.sigma_md, doubt * along.speed);
}

void SensorDepth::At(std::span<const UtcTime> utc, DepthGrid::Asks asks, double doubt,
                     AlongHoleBlock& along) {
  const bool shifts = corrects_ || doubt > 0;  // which takes all
  grid_.At(utc, shifts ? DepthGrid::Asks::kAll : asks, along);
  if (!shifts) {
    along.md.head(static_cast<Eigen::Index>(utc.size())) += sensor_below_reference_;
    return;
  }
  for (std::size_t i = 0; i < utc.size(); ++i) {
    AlongHole one = along.At(i);
    ShiftToSensor(utc[i], doubt, one);
    along.Set(i, one);
  }
}

}  // namespace wellgyro
