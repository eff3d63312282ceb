#pragma once

#include <Eigen/Core>

#include "wellgyro/estimate/elimination.h"
#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/node.h"

namespace wellgyro {

/// Regression of a position error on the newest node: p = by [node; border] + e, cov(e) = cov_W, e
/// independent of every later measurement. p is the error of the run's deepest place so far as seen
/// from its first node, by attitude errors alone. An update of the newest node thereby updates the
/// whole way behind it without another pass.
struct WayBehind {
  double deepest = 0;                                                        ///< [m]
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kNodeMax + kBorderMax> by;  ///< empty: none yet
  Eigen::Matrix3d cov_W = Eigen::Matrix3d::Zero();                           ///< [m^2]
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
