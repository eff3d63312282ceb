#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/earth/earth.h"
#include "wellgyro/estimate/knot_rows.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/run_state.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// The site at `p_W` [m] from `first`, north, east, down; within what a well can reach.
Site SiteBy(const Site& first, const Eigen::Vector3d& p_W);

/// Where every knot of a run stands by the nodes as they are now: site, rotation of L, and the
/// acceleration of the path across itself: speed squared by the hole's curvature, which is the
/// tangents' change by the way gone in five knots, and never the tool's shaking: a whirl would
/// rectify with it. Of a hole that waves in 15 knots .3 % are lost, in 6 a ninth.
/// `first`: of the run; `before`: where a part of it begins, nullptr: there.
void PlaceKnots(const Site& first, const RunState* before, std::span<const RunKnot> knots,
                std::span<const Node> nodes, std::vector<KnotPlace>& places);

/// KnotPlace::roll_bow of every knot where gravity does not show the roll [rad]. A roll of constant
/// acceleration a [rad/s^2] differs from its chord over the knot's length t by -a t^2 / 12 in the
/// mean. a is the central difference of `roll_rates` [rad/s] of the knots on both sides: truncation
/// error 5 % for a swing with a period of 15 knots, a quarter for one of 6. The same bow of psi, by
/// three points, is subtracted.
void BowKnots(std::span<const RunKnot> knots, std::span<const double> roll_rates,
              std::vector<KnotPlace>& places);

}  // namespace wellgyro
