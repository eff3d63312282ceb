#include "wellgyro/trajectory/leg_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace wellgyro {
namespace {

using Eigen::Vector3d;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An arc of up to half a circle is nowhere further from its chord than in its middle.
double Sagitta(const LegArc& arc) {
  const double half = arc.curvature * arc.length / 2;
  if (half < 1e-3) return arc.length * half / 4;
  return (1 - std::cos(half)) / arc.curvature;
}

double GapToPoint(const Vector3d& low_W, const Vector3d& high_W, const Vector3d& point_W) {
  const Vector3d beyond = (low_W - point_W).cwiseMax(point_W - high_W).cwiseMax(0.0);
  return beyond.norm();
}

}  // namespace

LegTree::LegTree(std::vector<LegArc> legs, const std::vector<LegReach>& reach)
    : legs_(std::move(legs)) {
  if (legs_.empty()) throw std::invalid_argument("LegTree: no leg");
  if (!reach.empty() && reach.size() != legs_.size()) {
    throw std::invalid_argument("LegTree: not one reach a leg");
  }
  leaves_ = std::bit_ceil(legs_.size());
  nodes_.assign(2 * leaves_,
                {Vector3d::Constant(kInfinity), Vector3d::Constant(-kInfinity), LegReach{}});
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    const Vector3d end = PointOn(legs_[i], legs_[i].length);
    const double sagitta = Sagitta(legs_[i]);
    Node& node = nodes_[leaves_ + i];
    node.low_W = legs_[i].begin_W.cwiseMin(end).array() - sagitta;
    node.high_W = legs_[i].begin_W.cwiseMax(end).array() + sagitta;
    if (!reach.empty()) node.reach = reach[i];
  }
  for (std::size_t k = leaves_ - 1; k > 0; --k) {
    const Node &left = nodes_[2 * k], &right = nodes_[2 * k + 1];
    nodes_[k] = {left.low_W.cwiseMin(right.low_W), left.high_W.cwiseMax(right.high_W),
                 LegReach{std::max(left.reach.variance, right.reach.variance),
                          std::max(left.reach.radius, right.reach.radius)}};
  }
}

double LegTree::Gap(const Node& a, const Node& b) {
  const Vector3d beyond = (a.low_W - b.high_W).cwiseMax(b.low_W - a.high_W).cwiseMax(0.0);
  return beyond.norm();
}

LegTree::Place LegTree::Nearest(const Vector3d& point_W) const {
  Place best{0, 0, kInfinity};
  std::vector<std::pair<double, std::size_t>> open{{0.0, 1}};
  while (!open.empty()) {
    const auto [gap, k] = open.back();
    open.pop_back();
    if (!(gap < best.distance)) continue;
    if (IsLeaf(k)) {
      const LegArc& leg = legs_[k - leaves_];
      const double s = NearestOn(leg, point_W);
      const double distance = (PointOn(leg, s) - point_W).norm();
      if (distance < best.distance) best = {k - leaves_, s, distance};
      continue;
    }
    std::pair<double, std::size_t> near{
        GapToPoint(nodes_[2 * k].low_W, nodes_[2 * k].high_W, point_W), 2 * k};
    std::pair<double, std::size_t> far{
        GapToPoint(nodes_[2 * k + 1].low_W, nodes_[2 * k + 1].high_W, point_W), 2 * k + 1};
    if (far.first < near.first) std::swap(near, far);
    open.push_back(far);
    open.push_back(near);
  }
  return best;
}

LegTree::Pair LegTree::Nearest(const LegArc& other) const {
  const LegTree alone({other});
  const Node& box = alone.nodes_[1];
  Pair best;
  best.place = Nearest(PointOn(other, 0));
  std::vector<std::pair<double, std::size_t>> open{{0.0, 1}};
  while (!open.empty()) {
    const auto [gap, k] = open.back();
    open.pop_back();
    if (!(gap < best.place.distance)) continue;
    if (IsLeaf(k)) {
      const NearestPair pair = NearestBetween(other, legs_[k - leaves_]);
      if (pair.distance < best.place.distance) {
        best = {{k - leaves_, pair.s_second, pair.distance}, pair.s_first};
      }
      continue;
    }
    std::pair<double, std::size_t> near{Gap(nodes_[2 * k], box), 2 * k};
    std::pair<double, std::size_t> far{Gap(nodes_[2 * k + 1], box), 2 * k + 1};
    if (far.first < near.first) std::swap(near, far);
    open.push_back(far);
    open.push_back(near);
  }
  return best;
}

bool LegTree::AnyNear(const LegTree& a, const LegTree& b, const NearTest& near) {
  std::vector<std::pair<std::size_t, std::size_t>> open{{1, 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    const Node &left = a.nodes_[i], &right = b.nodes_[j];
    const double gap = Gap(left, right);
    if (gap == kInfinity || !near(gap, left.reach, right.reach)) continue;
    if (a.IsLeaf(i) && b.IsLeaf(j)) return true;
    // The larger box is opened.
    const double size_a = a.IsLeaf(i) ? -1 : (left.high_W - left.low_W).squaredNorm();
    const double size_b = b.IsLeaf(j) ? -1 : (right.high_W - right.low_W).squaredNorm();
    if (size_a >= size_b) {
      open.emplace_back(2 * i, j);
      open.emplace_back(2 * i + 1, j);
    } else {
      open.emplace_back(i, 2 * j);
      open.emplace_back(i, 2 * j + 1);
    }
  }
  return false;
}

}  // namespace wellgyro
