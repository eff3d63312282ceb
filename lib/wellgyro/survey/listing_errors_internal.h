#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/survey/well_uncertainty.h"
#include "wellgyro/uncertainty/station_errors.h"

namespace wellgyro {

/// A depth in a survey: in the leg that ends at station `below`, or at that station where
/// `fraction` is 1.
struct ListedPlace {
  std::size_t below = 1;
  double fraction = 1;  ///< of the leg, in (0, 1]; 0 only at the first station
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d bend = Eigen::Vector3d::Zero();  ///< d tangent / d MD [rad/m]
};

/// What one source does to a listing at given depths, from row `first` on.
struct ListedErrors {
  std::size_t first = 0;
  std::size_t last = 0;                    ///< below this row no direction is wrong
  std::vector<Eigen::Vector3d> direction;  ///< [rad]
  std::vector<Eigen::Vector3d> position;   ///< [m]
};

/// Carries the station errors of a survey to its listing at given depths.
class ListingErrors {
 public:
  /// `depths` increase and lie within the stations that `errors` serves.
  ListingErrors(const SurveyedWell& well, const SurveyErrors& errors,
                std::span<const double> depths);

  const std::vector<ListedPlace>& places() const { return places_; }
  /// Of one source and group, by its stations in order; as long as depths, zero above `first`.
  void Carry(std::span<const StationError> factor, ListedErrors& listed) const;

 private:
  const SurveyedWell& well_;
  const SurveyErrors& errors_;
  std::vector<Eigen::Vector3d> tangent_;
  std::vector<ListedPlace> places_;
};

/// Places of `depths` in a survey.
std::vector<ListedPlace> PlacesIn(const SurveyedWell& well, std::span<const double> depths);

}  // namespace wellgyro
