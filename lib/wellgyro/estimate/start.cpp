#include "wellgyro/estimate/start.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "wellgyro/base/angle.h"
#include "wellgyro/estimate/guess_pass.h"
#include "wellgyro/estimate/hidden_roll.h"
#include "wellgyro/estimate/run_solver.h"
#include "wellgyro/math/rotation.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;

constexpr int kHeadings = 8;   // one of them is within 22.5 deg of any
constexpr int kApproach = 15;  // steps from there: three for the heading, the rest for the roll
// Solutions of one minimum that stop at a thousandth of a sigma end nearer to each other; no two
// minima of a heading that are nearer than half a degree have been seen.
constexpr double kSame = 0.01;  // [rad]

/// Inclination and toolface by the first knot that gravity levels, azimuth zero.
Matrix3d LevelAttitude(std::span<const RunKnot> knots) {
  for (const RunKnot& knot : knots) {
    if (!knot.increment.level) continue;
    const Eigen::Vector3d& f = knot.increment.force_M;
    return AttitudeMatrix(0, std::atan2(std::hypot(f.x(), f.y()), -f.z()),
                          std::atan2(-f.y(), f.x())) *
           RotationZ(-knot.increment.roll_before);
  }
  return Matrix3d::Identity();
}

/// Distributes `angle` over the hidden knots between two nodes, by their lengths, as further roll.
void Spread(double angle, std::span<const RunKnot> knots, std::size_t begin, std::size_t end,
            std::vector<double>& extra) {
  const auto weight = [&](std::size_t k) {
    return RollIsHidden(knots[k]) ? knots[k].increment.seconds : 0.0;
  };
  double sum = 0;
  for (std::size_t k = begin; k < end; ++k) sum += weight(k);
  if (!(sum > 0)) return;
  for (std::size_t k = begin; k < end; ++k) extra[k] += angle * weight(k) / sum;
}

}  // namespace

NodeGuess GuessOf(const EstimateSetup& setup, std::span<const RunKnot> knots, const Start& start,
                  std::span<const double> hidden_roll) {
  GuessPass pass(setup, knots, hidden_roll);
  Matrix3d first = LevelAttitude(knots);
  pass.Begin(first);
  std::size_t from = 0;
  const auto heading = [&](const Anchor& anchor) {
    pass.Run(from, anchor.node);
    return AngleAboutZ(anchor.R_LT * pass.nodes()[anchor.node].R_LT.transpose());
  };
  // The Earth's rate depends on the heading: until it stays to a milliradian.
  for (int i = 0; i < 3; ++i) {
    first = RotationZ(heading(start.front())) * first;
    pass.Begin(first);
  }
  pass.Run(0, start.front().node);
  from = start.front().node;
  for (const Anchor& anchor : std::span(start).subspan(1)) {
    for (int i = 0; i < 2; ++i) {
      Spread(heading(anchor), knots, from, anchor.node, pass.extra_roll());
    }
    pass.Run(from, anchor.node);
    from = anchor.node;
  }
  pass.Run(from, knots.size());
  return std::move(pass).nodes();
}

NodeGuess GuessOf(const EstimateSetup& setup, std::span<const RunKnot> knots,
                  std::span<const Matrix3d> R_LT) {
  const std::vector<double> hidden_roll = HiddenRoll(knots, setup);
  GuessPass pass(setup, knots, hidden_roll);
  pass.Begin(R_LT.front());
  pass.Run(0, knots.size());
  NodeGuess nodes = std::move(pass).nodes();
  for (std::size_t k = 0; k < R_LT.size(); ++k) nodes[k].R_LT = R_LT[k];
  return nodes;
}

Anchor AnchorOf(const EstimateSetup& setup, std::span<const RunKnot> knots, const AzimuthTie& tie) {
  const std::vector<double> hidden_roll = HiddenRoll(knots, setup);
  GuessPass pass(setup, knots, hidden_roll);
  pass.Begin(LevelAttitude(knots));
  pass.Run(0, tie.node);
  const Matrix3d R_LT = pass.nodes()[tie.node].R_LT;
  const Eigen::Vector3d d = tie.of_mark ? R_LT.col(0) : R_LT.col(2);
  return {tie.node, RotationZ(tie.azimuth - std::atan2(d.y(), d.x())) * R_LT};
}

std::vector<NodeGuess> GuessesOfHeadings(const EstimateSetup& setup,
                                         std::span<const RunKnot> knots) {
  const Matrix3d level = LevelAttitude(knots);
  const std::vector<double> hidden_roll = HiddenRoll(knots, setup);
  RunSolver solver(setup, knots);
  std::vector<NodeGuess> guesses;
  for (int i = 0; i < kHeadings; ++i) {
    solver.Begin(RotationZ(i * kTwoPi / kHeadings) * level, hidden_roll);
    if (!solver.Approach(kApproach)) continue;
    const auto same = [&](const NodeGuess& g) { return SameSolution(g, solver.nodes()); };
    if (std::none_of(guesses.begin(), guesses.end(), same)) guesses.push_back(solver.nodes());
  }
  return guesses;
}

bool SameSolution(std::span<const Node> a, std::span<const Node> b) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    if ((a[k].R_LT - b[k].R_LT).norm() > std::sqrt(2.0) * kSame) return false;
  }
  return true;
}

}  // namespace wellgyro
