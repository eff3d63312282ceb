#include "wellgyro/estimate/way_behind.h"

#include <algorithm>

namespace wellgyro {

double Deepens(double from_md, double to_md, double deepest) {
  return std::max(0.0, to_md - std::max(from_md, deepest));
}

WayBehind WayFrom(const Layout& layout, const Node& first) {
  WayBehind way;
  way.deepest = first.md;
  way.by.setZero(3, layout.node + layout.border);
  return way;
}

void CarryWay(const Layout& layout, const Node& from, const Node& to, const BehindMatrix& gain,
              const NodeMatrix& remainder, WayBehind& way) {
  const double half = 0.5 * Deepens(from.md, to.md, way.deepest);
  way.by.middleCols<3>(layout.phi) += half * TangentByPhi(from.R_LT);
  // x_from = gain [x_to; border] + e.
  const Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kNodeMax> node =
      way.by.leftCols(layout.node);
  way.cov_W += node * remainder * node.transpose();
  way.by.leftCols(layout.node).setZero();
  way.by += node * gain;
  way.by.middleCols<3>(layout.phi) += half * TangentByPhi(to.R_LT);
  way.deepest = std::max(way.deepest, to.md);
}

}  // namespace wellgyro
