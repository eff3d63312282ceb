#include "wellgyro/estimate/run_state.h"

#include "wellgyro/math/rotation.h"
#include "wellgyro/math/so3.h"

namespace wellgyro {

EdgeVector AwayFrom(const RunState& state, const Layout& layout, const Node& to,
                    const BorderVector& border) {
  const Node& known = state.node();
  EdgeVector away = EdgeVector::Zero(layout.node + layout.border);
  away.segment<3>(layout.phi) = Log(known.R_LT.transpose() * to.R_LT);
  away[layout.roll] = to.roll_rate - known.roll_rate;
  away[layout.depth] = to.md - known.md;
  away[layout.speed] = to.speed - known.speed;
  const auto of_gyros = [&](int column, const Eigen::Vector3d& by) {
    if (column != kAbsent) away.segment(column, layout.gyros) = by.head(layout.gyros);
  };
  of_gyros(layout.walk, to.walk_T - known.walk_T);
  of_gyros(layout.markov, to.markov_T - known.markov_T);
  if (layout.swing != kAbsent) away.segment<2>(layout.swing) = to.swing - known.swing;
  away.tail(layout.border) = border - state.border;
  return away;
}

}  // namespace wellgyro
