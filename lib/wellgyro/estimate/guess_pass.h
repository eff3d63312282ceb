#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/roll_track.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// How the roll is sought in the knots where it is hidden. None leads to the solution always: where
/// the first does not, the others are tried.
enum class RollSearch {
  kNeighbours,  ///< by the median over the knots about each, see HiddenRoll()
  kTrack,       ///< by the rate across in windows, see TrackRoll()
  kTrackAlone,  ///< the same, and neither gravity nor the Earth turns the tool from knot to knot
};
inline constexpr RollSearch kOtherSearches[] = {RollSearch::kTrack, RollSearch::kTrackAlone};

/// Places the nodes of a run one after the other: the gyros carry the axis, gravity turns the tool
/// about it. A first guess, from which a RunSolver begins.
class GuessPass {
 public:
  /// `knots` must outlive this object; at least one.
  GuessPass(const EstimateSetup& setup, std::span<const RunKnot> knots,
            RollSearch search = RollSearch::kNeighbours);

  /// The attitude of node 0.
  void Begin(const Eigen::Matrix3d& R_LT) { nodes_[0].R_LT = R_LT; }
  /// Of each knot, where the roll inside it was not seen and is known to be more [rad].
  std::vector<double>& extra_roll() { return extra_roll_; }
  /// That the Earth shows where the roll is hidden, as far as the search finds them.
  const std::vector<NodeHeading>& headings() const { return track_.headings; }
  /// The nodes after `begin`, which stands, up to `end`.
  void Run(std::size_t begin, std::size_t end);
  const std::vector<Node>& nodes() const& { return nodes_; }
  std::vector<Node> nodes() && { return std::move(nodes_); }

 private:
  double latitude_;
  std::span<const RunKnot> knots_;
  RollSearch search_;
  std::vector<double> extra_roll_;
  std::vector<bool> steady_;
  RollTrack track_;
  std::vector<Node> nodes_;
};

}  // namespace wellgyro
