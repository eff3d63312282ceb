#pragma once

#include <Eigen/Core>

#include "wellgyro/estimate/elimination.h"
#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/node.h"

namespace wellgyro {

/// The error of a run's deepest place so far as seen from its first node, attitudes alone, by what
/// is known at its newest node: p = by [node; border] + e, cov(e) = cov, e independent of all that
/// comes later. Whatever a run learns later of its newest node it learns by this of the way behind.
struct WayBehind {
  double deepest = 0;                                                        ///< [m]
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kNodeMax + kBorderMax> by;  ///< empty: none yet
  Eigen::Matrix3d cov = Eigen::Matrix3d::Zero();                             ///< [m^2]
};

/// A way that begins at this node.
WayBehind WayFrom(const Layout& layout, const Node& first);

/// From one node to the next: the hole between them is summed by the mean of their tangents, as far
/// as it is deeper than all before. `gain`, `remainder`: of the first of the two, eliminated.
void CarryWay(const Layout& layout, const Node& from, const Node& to, const BehindMatrix& gain,
              const NodeMatrix& remainder, WayBehind& way);

/// How much deeper than `deepest` the leg between two depths leads [m].
double Deepens(double from_md, double to_md, double deepest);

}  // namespace wellgyro
