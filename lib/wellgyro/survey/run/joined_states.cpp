#include "wellgyro/survey/run/joined_states.h"

#include <cstddef>

#include "wellgyro/attitude/along_hole_covariance.h"

namespace wellgyro {
namespace {

/// E[x y'] of the state x of `before` and y of `next`: y depends on what was before it by x alone,
/// and `on_the_way` is x as it was known then.
StationMatrix Bridge(const StationState& before, const StationState& on_the_way,
                     const StationState& next) {
  const StationMatrix& cross = next.cov_with_previous;
  if (cross.rows() != before.cov.rows() || cross.rows() != on_the_way.cov.rows()) return {};
  return before.cov * SolveCovariance(on_the_way.cov, cross);
}

}  // namespace

std::vector<StationState> JoinStates(std::span<const StationState> adjusted,
                                     std::span<const StationState> known) {
  std::vector<StationState> states(adjusted.begin(), adjusted.end());
  states.reserve(known.size());
  for (std::size_t i = states.size(); i < known.size(); ++i) {
    states.push_back(known[i]);
    if (i > 0 && i == adjusted.size()) {
      states[i].cov_with_previous = Bridge(states[i - 1], known[i - 1], known[i]);
    }
  }
  return states;
}

}  // namespace wellgyro
