#include "wellgyro/survey/joined_states.h"

#include <cmath>
#include <cstddef>

namespace wellgyro {
namespace {

/// E[x y'] of the state x of `before` and y of `next`, by what the filter knows of the azimuth of
/// both: `filtered` is the station of `before` in the filter.
FilterMatrix Bridge(const StationState& before, const StationState& filtered,
                    const StationState& next) {
  FilterMatrix cross = FilterMatrix::Zero(before.cov.rows(), next.cov.rows());
  const double variance = before.cov(0, 0) * filtered.cov(0, 0);
  if (next.cov_with_previous.rows() == 0 || !(variance > 0)) return cross;
  cross = before.cov.col(0) * next.cov_with_previous.row(0) / std::sqrt(variance);
  return cross;
}

}  // namespace

std::vector<StationState> JoinStates(std::span<const StationState> adjusted,
                                     std::span<const StationState> backwards,
                                     std::span<const StationState> filtered) {
  std::vector<StationState> states(adjusted.begin(), adjusted.end());
  states.reserve(filtered.size());
  for (std::size_t i = states.size(); i < filtered.size(); ++i) {
    const bool later = filtered[i].attitude.azimuth_known || i >= backwards.size();
    states.push_back(later ? filtered[i] : backwards[i]);
    if (i > 0 && i == adjusted.size()) {
      states[i].cov_with_previous = Bridge(states[i - 1], filtered[i - 1], filtered[i]);
    }
  }
  return states;
}

}  // namespace wellgyro
