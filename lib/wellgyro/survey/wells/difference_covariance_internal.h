#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/survey/hole/hole_roughness_internal.h"
#include "wellgyro/survey/wells/compare.h"

namespace wellgyro {

/// The differences of two surveys at given depths, second less first, in directions and with their
/// covariance. Directions are in the plane across the mean of both: (high side, right) [rad].
struct DifferenceCovariance {
  std::vector<Eigen::Vector2d> difference;
  std::vector<Eigen::Vector2d> bend;   ///< of the hole [rad/m]
  std::vector<Eigen::Vector2d> sigma;  ///< of `difference`
  /// Of the places, each survey summed over the stations of CommonStations [m].
  std::vector<Eigen::Vector3d> summed_alike_W;
  std::vector<Eigen::Matrix3d> cov_p_W;  ///< of `summed_alike_W` [m^2]
  HoleRoughness roughness;
  std::vector<std::size_t> joint;  ///< rows of cov_direction; empty where it is not known
  Eigen::MatrixXd cov_direction;   ///< high side of all joint rows, then right of all
};

/// `depths` lie in [begin, end], which both surveys reach.
DifferenceCovariance CovarianceOfDifference(const ComparedSurvey& first,
                                            const ComparedSurvey& second, double begin, double end,
                                            std::span<const double> depths,
                                            const CompareOptions& options);

}  // namespace wellgyro
