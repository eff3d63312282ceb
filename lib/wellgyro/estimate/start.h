#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// The attitude of one node, found at rest or told, of which the heading counts.
struct Anchor {
  std::size_t node = 0;
  Eigen::Matrix3d R_LT = Eigen::Matrix3d::Identity();
};
/// From where a run may be begun. The first anchor gives its heading; where the roll was not seen
/// all the way from one to the next, near vertical, what is missing of it is spread over that part.
using Start = std::vector<Anchor>;

/// All nodes of a run, as a solver may begin from.
using NodeGuess = std::vector<Node>;

struct Starts {
  std::vector<Start> anchored;
  std::function<NodeGuess()> otherwise;  ///< asked where none of these leads to what fits
};

/// The nodes as the depth has them, with these attitudes, one for each node.
NodeGuess GuessOf(const EstimateSetup& setup, std::span<const RunKnot> knots,
                  std::span<const Eigen::Matrix3d> R_LT);

/// The nodes by a forward pass from where `start` has them, with HiddenRoll() of the knots. At
/// least one knot and one anchor.
NodeGuess GuessOf(const EstimateSetup& setup, std::span<const RunKnot> knots, const Start& start,
                  std::span<const double> hidden_roll);

/// The heading that a tie gives, where the nodes would stand without any.
Anchor AnchorOf(const EstimateSetup& setup, std::span<const RunKnot> knots, const AzimuthTie& tie);

/// The solutions that differ among those that eight headings lead to, each once: a run whose motion
/// shows north has one, along a straight horizontal hole its mirror stands beside it.
std::vector<NodeGuess> GuessesOfHeadings(const EstimateSetup& setup,
                                         std::span<const RunKnot> knots);

/// Two solutions of a run that Gauss-Newton reached from two sides are one.
bool SameSolution(std::span<const Node> a, std::span<const Node> b);

}  // namespace wellgyro
