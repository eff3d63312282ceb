#include "wellgyro/survey/stations/station_plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "wellgyro/survey/stations/choose.h"

namespace wellgyro {

StationPlan::StationPlan(const Job& job) : every_(job.stations.every) {
  for (double md : job.stations.at) at_.push_back({md, true});
  if (!job.tie_in.inclination) at_.push_back({job.tie_in.md, false});
  if (job.alignment.at_md) at_.push_back({*job.alignment.at_md, false});
  std::stable_sort(at_.begin(), at_.end(),
                   [](const Target& a, const Target& b) { return a.md < b.md; });
}

void StationPlan::Between(double from, double to, bool inclusive,
                          std::vector<Target>& targets) const {
  targets.clear();
  const bool down = to >= from;
  const double low = std::min(from, to), high = std::max(from, to);
  const auto inside = [&](double md) {
    if (md < low || md > high) return false;
    return inclusive || md != from;
  };
  for (const Target& target : at_) {
    if (inside(target.md)) targets.push_back(target);
  }
  if (every_ > 0) {
    for (double k = std::ceil(low / every_); k * every_ <= high; ++k) {
      if (inside(k * every_)) targets.push_back({k * every_, true});
    }
  }
  std::stable_sort(targets.begin(), targets.end(), [down](const Target& a, const Target& b) {
    return down ? a.md < b.md : a.md > b.md;
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (kept > 0 && std::abs(targets[i].md - targets[kept - 1].md) <= kSameDepth) {
      // The one that was asked for stands for both.
      if (targets[i].listed && !targets[kept - 1].listed) targets[kept - 1] = targets[i];
    } else {
      targets[kept++] = targets[i];
    }
  }
  targets.resize(kept);
}

}  // namespace wellgyro
