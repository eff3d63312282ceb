#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// Of the tool's x axis near vertical, true, at a node [rad].
struct NodeHeading {
  std::size_t node = 0;
  double heading = 0;
};

/// How a run turns where gravity hardly shows it.
struct RollTrack {
  std::vector<double> beyond_psi;     ///< of each hidden knot, roll rate less that of psi [rad/s]
  std::vector<NodeHeading> headings;  ///< by the Earth's rate, in the order of time
  bool alone = false;  ///< neither gravity nor the Earth turns the tool from knot to knot as well
};

/// By the median over the knots about each, see HiddenRoll(): without headings.
RollTrack RollOfNeighbours(std::span<const RunKnot> knots, const EstimateSetup& setup);

/// By windows of 40 knots, in each of which the tool turns at one rate while its axis leans and
/// bends: what gyros and accelerometers read then is a line at that rate beside what they read
/// wrongly and steadily, which would pull a phase from knot to knot. The rates are the likeliest
/// sequence over all windows; the phase of the gyros' line is the heading, to about 0.1 rad at 45
/// deg of latitude with gyros of 0.05 deg/sqrt(h), so that turns are counted without drift. A
/// swing of the roll within a window leaves the line its place, as its middle, up to 30 deg.
///
/// For the start of a solution only, never a measurement: where the hole bends hard a window may
/// tell a rate that is wrong, and a heading by half a turn.
RollTrack TrackRoll(std::span<const RunKnot> knots, const EstimateSetup& setup);

}  // namespace wellgyro
