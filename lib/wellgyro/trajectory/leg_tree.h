#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/trajectory/leg_arc.h"

namespace wellgyro {

/// How far a leg reaches beside its own line: of each, the most on it.
struct LegReach {
  double variance = 0;  ///< of its position, in any direction [m^2]
  double radius = 0;    ///< of the hole [m]
};

/// The legs of one hole in order, in a binary tree of boxes: what is near is found in O(log n).
class WELLGYRO_EXPORT LegTree {
 public:
  /// `reach` is as long as `legs`, or empty. Throws std::invalid_argument when it is neither, or
  /// when there is no leg.
  explicit LegTree(std::vector<LegArc> legs, const std::vector<LegReach>& reach = {});

  const std::vector<LegArc>& legs() const { return legs_; }

  struct Place {
    std::size_t leg = 0;
    double s = 0;         ///< along it [m]
    double distance = 0;  ///< [m]
  };
  /// The nearest place to `point_W`; the first of several that are equally near.
  Place Nearest(const Eigen::Vector3d& point_W) const;

  struct Pair {
    Place place;
    double s = 0;  ///< along the arc that was asked about [m]
  };
  /// The nearest place to the arc `other`, as NearestBetween finds it.
  Pair Nearest(const LegArc& other) const;

  /// Whether `near`, asked about a lower bound of the distance of two boxes [m] and the reach of
  /// what they hold, is true of any leg of `a` and leg of `b`. `near` must not turn false when the
  /// distance falls or a reach grows.
  using NearTest = std::function<bool(double distance, const LegReach&, const LegReach&)>;
  static bool AnyNear(const LegTree& a, const LegTree& b, const NearTest& near);

 private:
  struct Node {
    Eigen::Vector3d low_W, high_W;  ///< [m]
    LegReach reach;
  };

  bool IsLeaf(std::size_t node) const { return node >= leaves_; }
  static double Gap(const Node& a, const Node& b);

  std::vector<LegArc> legs_;
  /// A heap: node k over 2k and 2k + 1, leaves from leaves_; places without a leg are empty boxes.
  std::vector<Node> nodes_;
  std::size_t leaves_ = 1;
};

}  // namespace wellgyro
