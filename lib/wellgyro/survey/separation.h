#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/well_uncertainty.h"

namespace wellgyro {

/// Two surveys of one hole are compared at equal MD and share well-by-well errors too; two wells at
/// the closest points of their paths.
enum class Pairing { kTwoWells, kSameHole };

/// One point of the first survey against the second.
struct Separation {
  double md = 0;                                     ///< station of the first [m]
  double other_md = 0;                               ///< on the second [m]
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();  ///< from the first to the second [m]
  double distance = 0;                               ///< [m]
  Eigen::Matrix3d cov = Eigen::Matrix3d::Zero();     ///< of the vector, shared errors out [m^2]
  double sigma =
      0;  ///< of the distance, along the vector; of the worst direction where both meet [m]
  std::optional<double> sigmas;  ///< distance / sigma; absent where sigma is zero
};

/// A survey with what is known of its errors.
struct UncertainWell {
  const SurveyedWell* well = nullptr;
  const PositionUncertainty* errors = nullptr;
};

/// Separation at every station of `first` that has a covariance; both in one frame. With
/// C the covariances and E the errors that both share, term by term under the same name,
///   C = C1 + C2 - sum (E1 E2' + E2 E1').
/// The closest point is taken on the straight lines between stations, where covariance and errors
/// of the second are interpolated. Same hole: stations of the first outside the second's are left.
/// Throws std::invalid_argument when either has fewer than two covariances.
WELLGYRO_EXPORT std::vector<Separation> Separations(const UncertainWell& first,
                                                    const UncertainWell& second, Pairing pairing);

}  // namespace wellgyro
