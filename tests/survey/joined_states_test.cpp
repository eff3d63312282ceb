#include "wellgyro/survey/joined_states.h"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

namespace wellgyro {
namespace {

/// A walk of `states` numbers, each station's the one's before plus noise of variance `q`.
std::vector<StationState> Walk(int states, int stations, double first, double q) {
  std::vector<StationState> result(static_cast<std::size_t>(stations));
  FilterMatrix cov = first * FilterMatrix::Identity(states, states);
  cov.row(0).setConstant(0.3 * first);
  cov.col(0).setConstant(0.3 * first);
  cov(0, 0) = first;
  for (StationState& station : result) {
    station.attitude.azimuth_known = true;
    if (&station != &result.front()) station.cov_with_previous = cov;
    cov += q * FilterMatrix::Identity(states, states);
    station.cov = cov;
  }
  return result;
}

TEST(JoinStates, WhereAnAdjustmentMeetsTheFilterTheCovarianceRemainsOne) {
  const std::vector<StationState> filtered = Walk(5, 6, 4.0, 0.1);
  const std::vector<StationState> adjusted = Walk(8, 3, 0.5, 0.01);
  const std::vector<StationState> states = JoinStates(adjusted, {}, filtered);
  ASSERT_EQ(states.size(), filtered.size());
  EXPECT_EQ(states[2].cov.rows(), 8);
  EXPECT_EQ(states[4].cov_with_previous, filtered[4].cov_with_previous);
  const FilterMatrix& cross = states[3].cov_with_previous;
  ASSERT_EQ(cross.rows(), 8);
  ASSERT_EQ(cross.cols(), 5);
  Eigen::MatrixXd both(13, 13);
  both << states[2].cov, cross, cross.transpose(), states[3].cov;
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(both).eigenvalues().minCoeff(), 0);
  const auto correlation = [](double cov, double a, double b) { return cov / std::sqrt(a * b); };
  EXPECT_NEAR(correlation(cross(0, 0), states[2].cov(0, 0), states[3].cov(0, 0)),
              correlation(filtered[3].cov_with_previous(0, 0), filtered[2].cov(0, 0),
                          filtered[3].cov(0, 0)),
              1e-12);
}

TEST(JoinStates, BeforeTheFirstNorthStationsAreAsItShowedThem) {
  std::vector<StationState> filtered = Walk(4, 4, 1, 0.1);
  filtered[0].attitude.azimuth_known = filtered[1].attitude.azimuth_known = false;
  std::vector<StationState> backwards = Walk(4, 3, 2, 0.1);
  const std::vector<StationState> states = JoinStates({}, backwards, filtered);
  EXPECT_EQ(states[0].cov, backwards[0].cov);
  EXPECT_EQ(states[1].cov, backwards[1].cov);
  EXPECT_EQ(states[2].cov, filtered[2].cov);
  EXPECT_EQ(states[3].cov, filtered[3].cov);
}

}  // namespace
}  // namespace wellgyro
