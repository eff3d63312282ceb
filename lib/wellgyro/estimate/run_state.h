#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/estimate/way_behind.h"

namespace wellgyro {

/// What is known of a run at one of its nodes from everything before it: all it takes to go on.
struct RunState {
  static constexpr std::size_t kTail = 4;  ///< nodes: those between which the hole's bend is read

  EstimateSetup setup;            ///< with the noise as found
  std::array<Node, kTail> nodes;  ///< the newest last
  BorderVector border;
  EdgeMatrix information;  ///< of [newest node; border]
  /// E[x (node; border)'] = link information^-1, x of the last marked node; empty: none was.
  Eigen::MatrixXd link;
  WayBehind way;                                  ///< back to node 0 of the run
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  ///< from node 0 of the run, L taken for W [m]
  double seconds = 0;                             ///< since then

  const Node& node() const { return nodes.back(); }
};

/// From what is known to this node and border.
EdgeVector AwayFrom(const RunState& known, const Layout& layout, const Node& to,
                    const BorderVector& border);

}  // namespace wellgyro
