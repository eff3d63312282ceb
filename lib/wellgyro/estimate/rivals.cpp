#include "wellgyro/estimate/rivals.h"

#include <algorithm>
#include <utility>

#include "wellgyro/record/decides.h"

namespace wellgyro {

void AddRival(Solution other, double evidence, std::span<const Node> nodes,
              std::vector<Solution>& rivals) {
  if (!(other.evidence - evidence < kDecides) || SameSolution(other.nodes, nodes)) return;
  const auto known = std::find_if(rivals.begin(), rivals.end(), [&](const Solution& rival) {
    return SameSolution(rival.nodes, other.nodes);
  });
  if (known == rivals.end()) {
    rivals.push_back(std::move(other));
  } else if (other.evidence < known->evidence) {
    *known = std::move(other);
  }
}

}  // namespace wellgyro
