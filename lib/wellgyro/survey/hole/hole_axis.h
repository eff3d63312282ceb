#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/node.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Attitudes R_LT at the ends of knots, their axis along the hole. `nodes`: at the begin of the
/// first knot and the end of each. `skew_T`: by which the gyros x and y see the roll [rad].
///
/// A tool that whirls points beside the hole at any instant, by as much as it whirls; the mean of
/// its axis over a knot hardly does. The axis at the end of a knot is that of the parabola along
/// the hole whose means over the two knots before and the two behind it are the tool's, as far as
/// those of the knots about it are as far off: a kink of the hole is no whirl. Of a whirl of 1 to
/// 5 Hz and knots of a second a sixth is left. The tool's own where a gap, a stretch of unknown
/// depth or an end of the run is nearer than two knots.
std::vector<Eigen::Matrix3d> OnHoleAxis(std::span<const RunKnot> knots, std::span<const Node> nodes,
                                        const Eigen::Vector2d& skew_T);

}  // namespace wellgyro
