#include "wellgyro/estimate/end_of_run.h"

#include <algorithm>
#include <cstddef>

namespace wellgyro {
namespace {

/// The way down to the deepest node or the way up from it, whichever reaches the shallower one.
struct DeepPass {
  std::size_t first = 0, last = 0;  ///< nodes
  double half = 0.5;                ///< of a knot's way, negative on the way up
};

DeepPass DeepPassOf(std::span<const Node> nodes) {
  const auto shallower = [](const Node& a, const Node& b) { return a.md < b.md; };
  const auto deepest = std::max_element(nodes.begin(), nodes.end(), shallower);
  const auto before = std::min_element(nodes.begin(), deepest + 1, shallower);
  const auto after = std::min_element(deepest, nodes.end(), shallower);
  const bool down = deepest->md - before->md >= deepest->md - after->md;
  return {static_cast<std::size_t>((down ? before : deepest) - nodes.begin()),
          static_cast<std::size_t>((down ? deepest : after) - nodes.begin()), down ? 0.5 : -0.5};
}

}  // namespace

std::vector<Eigen::Matrix3d> EndByPhi(std::span<const Node> nodes) {
  std::vector<Eigen::Matrix3d> end(nodes.size(), Eigen::Matrix3d::Zero());
  if (nodes.empty()) return end;
  const DeepPass pass = DeepPassOf(nodes);
  for (std::size_t k = pass.first; k < pass.last; ++k) {
    const double half = pass.half * (nodes[k + 1].md - nodes[k].md);
    for (const std::size_t i : {k, k + 1}) {
      end[i] += half * TangentByPhi(nodes[i].R_LT);
    }
  }
  return end;
}

Eigen::Vector3d EndByDepthScale(std::span<const Node> nodes) {
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  if (nodes.empty()) return end;
  const DeepPass pass = DeepPassOf(nodes);
  for (std::size_t k = pass.first; k < pass.last; ++k) {
    const double half = pass.half * (nodes[k + 1].md - nodes[k].md);
    end += half * (nodes[k].tangent_L() + nodes[k + 1].tangent_L());
  }
  return end;
}

}  // namespace wellgyro
