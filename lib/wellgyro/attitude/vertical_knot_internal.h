#pragma once

#include <complex>
#include <optional>

#include <Eigen/Core>

#include "wellgyro/attitude/vertical_core_internal.h"
#include "wellgyro/attitude/vertical_lift_internal.h"
#include "wellgyro/record/knot.h"

/// What VerticalFilter gives to a knot.
namespace wellgyro::vertical {

/// Slopes of an angle against the tool's errors and the Earth's rate, and its variance from noise.
struct Uncertain {
  using Slopes = Eigen::Matrix<double, 1, kColumns>;
  Slopes d = Slopes::Zero();
  double var = 0;  ///< [rad^2]

  Knot::SourceVector by_sources() const { return d.head<Knot::kSources>().transpose(); }
  /// Along x and y of L as real and imaginary part [s].
  std::complex<double> by_earth() const { return {d[kEarth], d[kEarth + 1]}; }
};

/// The filter at one instant, azimuth from where it counts [rad].
struct Cut {
  double azimuth = 0, inclination = 0, toolface = 0;
  Uncertain in_azimuth, in_inclination, in_toolface, in_sum;
};
Cut CutOf(const Core& core, const Eigen::Matrix3d& R_LT);

/// Where the filter counts azimuth from, and the Earth there.
struct Reference {
  std::optional<double> azimuth;  ///< true, where north is known [rad]
  double sigma = 0;               ///< of it [rad]
  double latitude = 0;            ///< [rad]

  Heading heading() const;
  double var_north() const;  ///< of a component of north, across what is known of it [rad^2]
  std::complex<double> to_north() const;
  double rate_across() const;  ///< of the Earth, horizontal [rad/s]
  double rate_up() const;      ///< [rad/s]
};

/// As far as north is unsure, what the Earth's rate may have done is noise [rad^2].
double VarOf(const Uncertain& angle, const Reference& reference);

/// Variance given to the knots since errors of the sum are counted, and before the last gap
/// [rad^2].
struct Counted {
  double var = 0, before_gap = 0;
  int knots = 0, since_gap = -1;  ///< -1: none yet
  bool in_gap = false;
};

/// From one cut to the next. `axial`: what this leaves behind is S - toolface (see Knot).
struct Leg {
  const Cut& before;
  const Cut& now;
  const Reference& reference;
  bool axial, heading_feeds_back;
  const Lift* lift;  ///< null: not known
};
/// All of the knot that leads along the hole, with its errors; length and gap are given.
void FillKnot(const Leg& leg, Counted* counted, Knot* knot);

}  // namespace wellgyro::vertical
