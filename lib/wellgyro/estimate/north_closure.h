#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/estimate/linear_run.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/setup.h"

namespace wellgyro {

/// What one north says against all the rest of the run.
struct NorthClosure {
  double angle = 0;  ///< azimuth by that north less azimuth by the rest [rad]
  double sigma = 0;  ///< of that; 0: the rest does not tell it [rad]
};

/// The closure of every north: case deletion as a mean shift (Cook and Weisberg 1982, 2.2.2). The
/// rows of one north are taken to be of a tool turned by d about the vertical, their column being
///   c = J_north v,   v = the turn of the attitudes at both ends of each knot about the vertical;
/// with s = c'P r and M = c'P c then d = -s / M of variance 1 / M, see Diagnose(). It is what the
/// run without these rows predicts, errors that both share counted once, and regular at vertical.
/// c'c - M is the variance of a sum of unknowns that is gathered backwards over the north's knots:
/// time is proportional to the knots.
/// `nodes`: about which `solved` was made linear. A sigma above kVagueAngle is not told: the rows
/// are not linear so far.
WELLGYRO_EXPORT std::vector<NorthClosure> NorthClosures(const LinearRun& solved,
                                                        std::span<const Node> nodes,
                                                        std::span<const NorthAt> norths);

}  // namespace wellgyro
