#pragma once

#include <span>
#include <vector>

#include "wellgyro/estimate/knot_rows.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Where every knot of a run stands by the nodes as they are now: site, rotation of L, and the
/// acceleration of the path across itself. That follows the hole's own curvature, the tangents
/// low-passed over 15 s, and never the tool's shaking: a whirl would rectify with it.
void PlaceKnots(const Site& first, std::span<const RunKnot> knots, std::span<const Node> nodes,
                std::vector<KnotPlace>& places);

}  // namespace wellgyro
