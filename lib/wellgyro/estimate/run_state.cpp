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
  if (layout.walk != kAbsent) away.segment<2>(layout.walk) = to.walk - known.walk;
  if (layout.markov != kAbsent) away.segment<2>(layout.markov) = to.markov - known.markov;
  if (layout.swing != kAbsent) away.segment<2>(layout.swing) = to.swing - known.swing;
  away.tail(layout.border) = border - state.border;
  return away;
}

}  // namespace wellgyro
