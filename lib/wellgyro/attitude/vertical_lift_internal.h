#pragma once

#include <complex>
#include <optional>

#include <Eigen/Core>

#include "wellgyro/attitude/vertical_core_internal.h"
#include "wellgyro/record/knot.h"

namespace wellgyro::vertical {

/// What of a Knot tells how the inclination grows; see there.
struct Lift {
  double lift = 0;
  double inclination_accel = 0;
  bool level = true;
  Knot::SourceVector d_lift = Knot::SourceVector::Zero();
  std::complex<double> rolled = 0;
  Eigen::Matrix<double, 2, Knot::kSources> rolled_toolface;
};

/// How the inclination grows by the transverse gyros and what the accelerometers read of it, turned
/// to the high side with a toolface that is known better than one sample shows it: what a tracker
/// of the high side would say, down to where the toolface itself is lost.
class LiftSums {
 public:
  /// One sample; `R_LT` at its middle, turning about z at `axial_rate` [rad/s].
  void Add(const Sensed& sensed, const Eigen::Matrix3d& R_LT, double axial_rate);
  /// The toolface used since the last call errs so by the tool's errors, and the tool turned by
  /// `regained` [rad] more than the rates said. To be called every fraction of a turn.
  void TakeToolface(const Knot::SourceVector& d_toolface, double regained);
  /// Time without samples begins or ends: what is held no longer belongs to one interval.
  void Break() { broken_ = true; }

  /// The interval of `seconds` ends `rest` [s] before the end of the last sample; what is left goes
  /// into the next. Nothing where not all of its samples were added.
  std::optional<Lift> Cut(double rest, double seconds, const Knot::SourceVector& d_toolface);

 private:
  enum Sum {
    kSeconds,
    kLift,    // V_r, V = W e^{iT} over the period
    kAcross,  // V_h
    kLevel,   // accelerometers' inclination dt
    kUnitC,   // cos T dt
    kUnitS,   // sin T dt
    kSpinC,   // rotation about z, times cos T
    kSpinS,
    kScaleX,  // what x adds to V_r
    kScaleY,
    kForce,  // g sin I dt
    kSums
  };
  using Sums = Eigen::Matrix<double, kSums, 1, Eigen::DontAlign>;

  using Rolled = Eigen::Matrix<double, 3, Knot::kSources, Eigen::DontAlign>;

  void Roll(const Sums& open, const Knot::SourceVector& d_toolface);
  Lift Of(const Sums& done) const;

  Sums sums_ = Sums::Zero(), part_ = Sums::Zero();  // of the interval, and its last sample's
  Sums open_ = Sums::Zero();                        // since the last TakeToolface()
  Rolled rolled_ = Rolled::Zero();                  // kUnitC, kUnitS, kAcross, times d_toolface
  bool level_ = true, part_level_ = true, broken_ = false;
};

}  // namespace wellgyro::vertical
