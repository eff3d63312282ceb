#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/hole/well_uncertainty.h"
#include "wellgyro/trajectory/leg_tree.h"

namespace wellgyro {

/// A survey with what is known of its errors.
struct UncertainWell {
  const SurveyedWell* well = nullptr;
  const PositionUncertainty* errors = nullptr;
};

/// The hole down to a measured depth.
struct HoleSection {
  double end_md = 0;  ///< [m]
  double radius = 0;  ///< of the open hole [m]
};

/// A well as a curve: arcs between its stations, with covariance and errors interpolated straight
/// along the hole. Reaches down to the last station with a covariance.
class WELLGYRO_EXPORT HoleLine {
 public:
  /// `well` must outlive it. Below the last of `sections` its radius holds on; none: radius 0.
  /// Throws std::invalid_argument when there are fewer than two covariances, sections do not go
  /// down, or a radius is negative or not finite.
  explicit HoleLine(const UncertainWell& well, std::span<const HoleSection> sections = {});

  struct Place {
    std::size_t leg = 0;
    double s = 0;  ///< along it [m]
  };
  const LegTree& tree() const { return tree_; }
  std::size_t stations() const { return tree_.legs().size() + 1; }
  const UncertainWell& well() const { return well_; }

  Place Station(std::size_t i) const;
  double Md(const Place& place) const;
  Eigen::Vector3d Position(const Place& place) const;
  Eigen::Vector3d Direction(const Place& place) const;
  Eigen::Matrix3d Cov(const Place& place) const;
  /// Position error of the i-th shared source [m].
  Eigen::Vector3d Shared(std::size_t i, const Place& place) const;
  double Radius(double md) const;

 private:
  double Fraction(const Place& place) const;
  static LegTree TreeOf(const UncertainWell& well, std::span<const HoleSection> sections);

  UncertainWell well_;
  std::vector<HoleSection> sections_;
  LegTree tree_;
};

}  // namespace wellgyro
