#include "wellgyro/survey/run/mirrors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Geometry>

#include "wellgyro/attitude/unseen.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/record/decides.h"

namespace wellgyro {
namespace {

// [m], of a leg between stations at one place: its bend of 0.1 deg keeps what they cost finite and
// is far below what tells mirrors apart.
constexpr double kLeastLength = 1;

/// A place where the hole has one of up to two directions.
struct MirrorNode {
  double md = 0;
  Draft* draft = nullptr;  ///< absent: the tie-in
  double variance = 0;     ///< of the direction [rad^2]
  std::array<Eigen::Vector3d, 2> tangent;
  std::array<double, 2> cost{};  ///< of each direction by itself
  std::size_t directions = 1;
  std::array<double, 2> above{}, below{};  ///< least cost of a path from there, its own included
};

MirrorNode NodeOf(Draft& draft, double share) {
  const AttitudeSample& a = draft.attitude;
  const double sine = std::sin(a.inclination);
  MirrorNode node{.md = draft.station.md, .draft = &draft};
  node.variance = sine * sine * a.cov_attitude(1, 1) + a.cov_attitude(0, 0);
  node.tangent[0] = Tangent(a.inclination, a.azimuth);
  if (!draft.mirror_azimuth) return node;
  node.tangent[1] = Tangent(a.inclination, *draft.mirror_azimuth);
  node.cost[1] = share * draft.mirror_cost;
  node.directions = 2;
  return node;
}

std::vector<MirrorNode> NodesOf(const Job& job, std::vector<Draft>& drafts) {
  const auto mirrored = static_cast<double>(std::count_if(
      drafts.begin(), drafts.end(), [](const Draft& d) { return d.mirror_azimuth.has_value(); }));
  std::vector<MirrorNode> nodes;
  if (mirrored == 0) return nodes;
  if (job.tie_in.azimuth) {
    nodes.push_back({.md = job.tie_in.md});
    nodes.back().tangent[0] = Tangent(*job.tie_in.inclination, *job.tie_in.azimuth);
  }
  for (Draft& draft : drafts) {
    if (!draft.state) nodes.push_back(NodeOf(draft, 1 / mirrored));
  }
  std::stable_sort(nodes.begin(), nodes.end(),
                   [](const MirrorNode& a, const MirrorNode& b) { return a.md < b.md; });
  return nodes;
}

double CostOfBend(const MirrorNode& a, std::size_t i, const MirrorNode& b, std::size_t j) {
  const double bend = UnseenHole().dogleg * std::max(b.md - a.md, kLeastLength);
  const double angle =
      std::atan2(a.tangent[i].cross(b.tangent[j]).norm(), a.tangent[i].dot(b.tangent[j]));
  return angle * angle / (bend * bend + a.variance + b.variance);
}

/// Least cost of each direction of `node` and a path on the far side of `next`.
void Extend(const MirrorNode& next, std::array<double, 2> MirrorNode::*sum, MirrorNode& node,
            bool next_is_deeper) {
  for (std::size_t i = 0; i < node.directions; ++i) {
    double least = HUGE_VAL;
    for (std::size_t j = 0; j < next.directions; ++j) {
      const double bend =
          next_is_deeper ? CostOfBend(node, i, next, j) : CostOfBend(next, j, node, i);
      least = std::min(least, (next.*sum)[j] + bend);
    }
    (node.*sum)[i] = node.cost[i] + least;
  }
}

void TakeMirror(Draft& draft) {
  AttitudeSample& a = draft.attitude;
  std::swap(a.azimuth, *draft.mirror_azimuth);
  draft.mirror_cost = -draft.mirror_cost;
  for (const int other : {0, 2}) {  // what raises the one lowers the other
    a.cov_attitude(1, other) = -a.cov_attitude(1, other);
    a.cov_attitude(other, 1) = -a.cov_attitude(other, 1);
  }
}

}  // namespace

void ResolveMirrors(const Job& job, std::vector<Draft>& drafts) {
  std::vector<MirrorNode> nodes = NodesOf(job, drafts);
  if (nodes.empty()) return;
  const std::size_t n = nodes.size();
  nodes.front().above = nodes.front().cost;
  nodes.back().below = nodes.back().cost;
  for (std::size_t i = 1; i < n; ++i) Extend(nodes[i - 1], &MirrorNode::above, nodes[i], false);
  for (std::size_t i = n - 1; i-- > 0;) Extend(nodes[i + 1], &MirrorNode::below, nodes[i], true);
  for (MirrorNode& node : nodes) {
    if (node.directions < 2) continue;
    const auto total = [&node](std::size_t i) {
      return node.above[i] + node.below[i] - node.cost[i];
    };
    const double mirror = total(1) - total(0);
    if (mirror < 0) TakeMirror(*node.draft);
    Quality& quality = node.draft->attitude.quality;
    if (std::abs(mirror) > kDecides) quality = Without(quality, Quality::kMirror);
  }
}

}  // namespace wellgyro
