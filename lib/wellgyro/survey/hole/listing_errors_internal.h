#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/survey/hole/well_uncertainty.h"
#include "wellgyro/uncertainty/station_errors.h"

namespace wellgyro {

/// A depth in a survey: in the leg that ends at station `below`, or at that station where
/// `fraction` is 1.
struct ListedPlace {
  std::size_t below = 1;
  double fraction = 1;  ///< of the leg, in (0, 1]; 0 only at the first station
  Eigen::Vector3d tangent_W = Eigen::Vector3d::UnitZ();  ///< as listed, by the leg's arc
  Eigen::Vector3d smooth_W = Eigen::Vector3d::UnitZ();   ///< by the spline through all stations
  Eigen::Vector3d bend_W = Eigen::Vector3d::Zero();      ///< d tangent / d MD of the hole [rad/m]
};

/// What one source does to a listing at given depths, from row `first` on.
struct ListedErrors {
  std::size_t first = 0;
  std::size_t last = 0;                          ///< below this row no direction is wrong
  std::vector<Eigen::Vector3d> direction_W;      ///< as listed for that depth [rad]
  std::vector<Eigen::Vector3d> measured_W;       ///< of it what is not the depth's [rad]
  std::vector<double> md;                        ///< listed less true [m]
  std::vector<Eigen::Vector3d> displacements_W;  ///< of all courses above, summed [m]
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
  const SurveyErrors& errors_;
  std::vector<Eigen::Vector3d> bend_W_;  ///< of the hole at stations [rad/m]
  std::vector<ListedPlace> places_;
};

/// Places of `depths` in a survey. Bends are at stations those of the cubic spline through all of
/// them, which errs by the fourth power of the spacing where a mean of the two arcs errs by the
/// second, and straight between: an error of depth moves every station along the hole.
std::vector<ListedPlace> PlacesIn(const SurveyedWell& well, std::span<const double> depths);

}  // namespace wellgyro
