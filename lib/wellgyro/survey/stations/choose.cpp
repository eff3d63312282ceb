#include "wellgyro/survey/stations/choose.h"

#include <algorithm>

namespace wellgyro {
namespace {

bool Better(const Station& a, const Station& b) {
  const double va = a.cov_md_inc_azi(2, 2), vb = b.cov_md_inc_azi(2, 2);
  if (va != vb) return va < vb;
  return a.utc < b.utc;
}

}  // namespace

std::vector<std::size_t> ChooseStations(std::span<const Station> stations) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const StationStatus status = stations[i].status;
    if (status != StationStatus::kRejected && status != StationStatus::kSuperseded) {
      order.push_back(i);
    }
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return stations[a].md < stations[b].md; });
  std::vector<std::size_t> chosen;
  for (std::size_t i : order) {
    if (chosen.empty() || stations[i].md - stations[chosen.back()].md > kSameDepth) {
      chosen.push_back(i);
    } else if (Better(stations[i], stations[chosen.back()])) {
      chosen.back() = i;
    }
  }
  return chosen;
}

}  // namespace wellgyro
