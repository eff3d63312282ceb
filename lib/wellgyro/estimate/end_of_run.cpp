#include "wellgyro/estimate/end_of_run.h"

#include <algorithm>
#include <cstddef>

namespace wellgyro {

std::vector<Eigen::Matrix3d> EndByPhi(std::span<const Node> nodes) {
  std::vector<Eigen::Matrix3d> end(nodes.size(), Eigen::Matrix3d::Zero());
  if (nodes.empty()) return end;
  const auto shallower = [](const Node& a, const Node& b) { return a.md < b.md; };
  const auto deepest = std::max_element(nodes.begin(), nodes.end(), shallower);
  const auto before = std::min_element(nodes.begin(), deepest + 1, shallower);
  const auto after = std::min_element(deepest, nodes.end(), shallower);
  const bool down = deepest->md - before->md >= deepest->md - after->md;
  const auto first = static_cast<std::size_t>((down ? before : deepest) - nodes.begin());
  const auto last = static_cast<std::size_t>((down ? deepest : after) - nodes.begin());
  for (std::size_t k = first; k < last; ++k) {
    const double half = (down ? 0.5 : -0.5) * (nodes[k + 1].md - nodes[k].md);
    for (const std::size_t i : {k, k + 1}) {
      end[i] += half * TangentByPhi(nodes[i].R_LT);
    }
  }
  return end;
}

}  // namespace wellgyro
