#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/fit/least_squares_internal.h"

namespace wellgyro {

/// A remark where a latitude of the other sign is the likelier one. With it every rate differs by
/// twice the Earth's along gravity, in proportion to the force, and gyros' force terms take that as
/// far as their form lets them: a rotor's four have two coefficients, so that its misaligned axes
/// contradict a wrong sign; nine of three gyros take all of it.
///
/// Odds: by the squares that are left (in those of the better fit's scatter), and by n force terms
/// as drawn from one normal distribution of unknown scale,
///   2 ln B = (chi-square - chi-square') / s^2 + n ln(sum G^2 / sum G'^2).
///
/// `other` gives the problem of the same rows with the other sign, about a solution of it;
/// `forces`: places of force terms among the parameters.
std::optional<std::string> OtherHemisphere(
    const LinearProblem& problem, const LinearSolution& solution,
    const std::function<LinearProblem(const Eigen::VectorXd& x)>& other,
    const std::vector<Eigen::Index>& forces);

}  // namespace wellgyro
