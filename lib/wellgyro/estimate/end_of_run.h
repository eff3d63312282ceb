#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/node.h"

namespace wellgyro {

/// How the deepest place of a run, as seen from its shallowest, moves with every node's phi:
/// tangents summed over the depths of the pass between them [m]. Zero of a run without depth.
std::vector<Eigen::Matrix3d> EndByPhi(std::span<const Node> nodes);
/// How the same place moves, all else being right, with the scale that depth marks read by: by the
/// whole way [m].
Eigen::Vector3d EndByDepthScale(std::span<const Node> nodes);

}  // namespace wellgyro
