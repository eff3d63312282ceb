#include "wellgyro/survey/run/joined_states.h"

#include <cstddef>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

namespace wellgyro {
namespace {

/// A walk of `states` numbers, each station's the one's before plus noise of variance `q`.
std::vector<StationState> Walk(int states, int stations, double first, double q) {
  std::vector<StationState> result(static_cast<std::size_t>(stations));
  StationMatrix cov = first * StationMatrix::Identity(states, states);
  cov.row(0).setConstant(0.3 * first);
  cov.col(0).setConstant(0.3 * first);
  cov(0, 0) = first;
  for (StationState& station : result) {
    if (&station != &result.front()) station.cov_with_previous = cov;
    cov += q * StationMatrix::Identity(states, states);
    station.cov = cov;
  }
  return result;
}

// The estimate on the way knew the station before to its covariance, the adjustment knows it
// better: what the next one owes to it shrinks as that did, and the two remain one covariance.
TEST(JoinStates, WhereAnAdjustmentMeetsWhatWasKnownTheCovarianceRemainsOne) {
  const std::vector<StationState> known = Walk(5, 6, 4.0, 0.1), adjusted = Walk(5, 3, 0.5, 0.01);
  const std::vector<StationState> states = JoinStates(adjusted, known);
  ASSERT_EQ(states.size(), known.size());
  EXPECT_EQ(states[2].cov, adjusted[2].cov);
  EXPECT_EQ(states[4].cov_with_previous, known[4].cov_with_previous);
  const StationMatrix& cross = states[3].cov_with_previous;
  Eigen::MatrixXd both(10, 10);
  both << states[2].cov, cross, cross.transpose(), states[3].cov;
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(both).eigenvalues().minCoeff(), 0);
  // x_3 = x_2 + noise, so that E[x_2 x_3'] is E[x_2 x_2'].
  EXPECT_LT((cross - adjusted[2].cov).norm(), 1e-12);
}

TEST(JoinStates, WithoutAnAdjustmentStatesAreAsKnown) {
  const std::vector<StationState> known = Walk(4, 4, 1, 0.1), states = JoinStates({}, known);
  ASSERT_EQ(states.size(), known.size());
  for (std::size_t i = 0; i < known.size(); ++i) {
    EXPECT_EQ(states[i].cov, known[i].cov);
    EXPECT_EQ(states[i].cov_with_previous, known[i].cov_with_previous);
  }
}

}  // namespace
}  // namespace wellgyro
