#include "wellgyro/estimate/north_closure.h"

#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "wellgyro/math/random.h"
#include "wellgyro/math/rotation.h"

#include "estimate/toy_run.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::kDenseKnots;
using test::ToyRun;

/// Attitudes every way up.
std::vector<Node> AnyNodes() {
  Random random(12);
  std::vector<Node> nodes(kDenseKnots + 1);
  for (Node& node : nodes) {
    node.R_LT = Exp({2 * random.Normal(), 2 * random.Normal(), 2 * random.Normal()});
  }
  return nodes;
}

constexpr std::size_t kBegin = 7, kEnd = 23;

/// What a turn of the stop's attitudes about the vertical adds to its rows of rest alone.
VectorXd TurnOfStop(const ToyRun& run, const MatrixXd& J, const std::vector<Node>& nodes) {
  VectorXd turn = VectorXd::Zero(J.cols());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    turn.segment<3>(static_cast<Index>(8 * k)) =
        nodes[k].R_LT.transpose() * Eigen::Vector3d::UnitZ();
  }
  const VectorXd all = J * turn;
  VectorXd column = VectorXd::Zero(J.rows());
  for (std::size_t k = kBegin; k < kEnd; ++k) {
    const Index row = run.RowOf(k, RowKind::kStill);
    column.segment<3>(row) = all.segment<3>(row);
  }
  return column;
}

/// The model with one unknown more, of this column, solved as a whole by QR.
void ExpectUnknownOf(const VectorXd& column, const ToyRun& run, const NorthClosure& closure) {
  const MatrixXd J = run.J();
  MatrixXd larger(J.rows(), J.cols() + 1);
  larger << J, column;
  const VectorXd x = larger.colPivHouseholderQr().solve(-run.r());
  const MatrixXd cov = (larger.transpose() * larger).inverse();
  const double last = x[J.cols()];
  EXPECT_NEAR(closure.sigma / std::sqrt(cov(J.cols(), J.cols())), 1, 1e-9);
  EXPECT_NEAR(closure.angle, last, 1e-9 * std::abs(last));
}

TEST(NorthClosure, IsTheUnknownOfALargerSystem) {
  ToyRun run(8);
  run.Rest(kBegin, kEnd);
  const std::vector<Node> nodes = AnyNodes();
  LinearRun solved(run);
  ASSERT_TRUE(solved.Solve());
  const std::vector<NorthAt> norths{{kBegin, kEnd}, {2, 7}};
  const std::vector<NorthClosure> closures = NorthClosures(solved, nodes, norths);
  ASSERT_EQ(closures.size(), 2u);
  ExpectUnknownOf(TurnOfStop(run, run.J(), nodes), run, closures[0]);
  EXPECT_EQ(closures[1].sigma, 0) << "nothing rests there";
}

// An azimuth from outside turns its own node alone, be it the first.
TEST(NorthClosure, OfAnAzimuthFromOutsideIsThatOfItsNode) {
  for (const std::size_t node : {0, 1, 14}) {
    const std::size_t knot = node > 0 ? node - 1 : 0;
    ToyRun run(10 + node);
    run.Tie(knot);
    run.Sharpen(30);  // as the rest of a run is, to less than kVagueAngle
    const std::vector<Node> nodes = AnyNodes();
    const MatrixXd J = run.J();
    VectorXd turn = VectorXd::Zero(J.cols());
    turn.segment<3>(static_cast<Index>(8 * node)) =
        nodes[node].R_LT.transpose() * Eigen::Vector3d::UnitZ();
    VectorXd column = VectorXd::Zero(J.rows());
    const Index row = run.RowOf(knot, RowKind::kAzimuth);
    column.segment<3>(row) = (J * turn).segment<3>(row);
    LinearRun solved(run);
    ASSERT_TRUE(solved.Solve());
    const NorthAt tie{knot, node, true};
    ExpectUnknownOf(column, run, NorthClosures(solved, nodes, {&tie, 1}).front());
  }
}

TEST(NorthClosure, FindsANorthThatIsTurned) {
  const std::vector<Node> nodes = AnyNodes();
  ToyRun run(9);
  run.Rest(kBegin, kEnd);
  const VectorXd column = TurnOfStop(run, run.J(), nodes);
  const auto closure = [&] {
    LinearRun solved(run);
    EXPECT_TRUE(solved.Solve());
    const NorthAt stop{kBegin, kEnd};
    return NorthClosures(solved, nodes, {&stop, 1}).front();
  };
  const NorthClosure before = closure();
  // The stop reads as if the tool were turned by 0.3 rad.
  run.Disturb(column, -0.3);
  EXPECT_NEAR(closure().angle - before.angle, 0.3, 1e-9);
  EXPECT_LT(std::abs(before.angle), 4 * before.sigma);
}

TEST(NorthClosure, OfRunsWithoutFaultIsNormal) {
  const std::vector<Node> nodes = AnyNodes();
  double squares = 0;
  constexpr int kRuns = 400;
  for (int seed = 0; seed < kRuns; ++seed) {
    ToyRun run(500 + static_cast<std::uint64_t>(seed));
    run.Rest(kBegin, kEnd);
    LinearRun solved(run);
    ASSERT_TRUE(solved.Solve());
    const NorthAt stop{kBegin, kEnd};
    const NorthClosure closure = NorthClosures(solved, nodes, {&stop, 1}).front();
    ASSERT_GT(closure.sigma, 0);
    squares += closure.angle * closure.angle / (closure.sigma * closure.sigma);
  }
  // Chi-square of 400, 0.1 % on either side.
  EXPECT_GT(squares, 318);
  EXPECT_LT(squares, 494);
}

}  // namespace
}  // namespace wellgyro
