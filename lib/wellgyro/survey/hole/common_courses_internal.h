#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/survey/hole/listing_errors_internal.h"

namespace wellgyro {

/// Depths that neither of two surveys of one hole samples more widely than: each is the nearest one
/// below the last in which both have had a station since, so that it is a station of the one that
/// is coarser there. From `begin` to `end`, both included, in which both lie.
std::vector<double> CommonStations(const SurveyedWell& first, const SurveyedWell& second,
                                   double begin, double end);

/// A survey summed over stations that need not be its own, with directions there by the spline
/// through its own: between them it loses what any other survey of the hole loses.
class CommonCourses {
 public:
  /// `common` increase and lie in the survey; above the first of them its own stations stay.
  /// `depths` lie between the first and the last of them.
  CommonCourses(const SurveyedWell& well, std::span<const double> common,
                std::span<const double> depths);

  /// Its listing at the stations, those above the common ones too.
  const SurveyedWell& well() const { return well_; }
  std::vector<double> stations() const;
  std::size_t first_common() const { return first_common_; }
  /// Of `depths`, in well().
  const std::vector<ListedPlace>& places() const { return places_; }
  Eigen::Vector3d Position(std::size_t row) const { return position_W_[row]; }

  /// What `errors`, of one source at all stations(), do to the positions at `depths` [m].
  std::vector<Eigen::Vector3d> Displaced(const ListedErrors& errors) const;

 private:
  SurveyedWell well_;
  std::size_t first_common_ = 0;
  std::vector<Eigen::Vector3d> tangent_W_, position_W_;
  std::vector<ListedPlace> places_;
};

}  // namespace wellgyro
