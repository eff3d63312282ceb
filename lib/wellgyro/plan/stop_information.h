#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/plan/plan_case.h"
#include "wellgyro/plan/run_so_far.h"

namespace wellgyro {

/// Where a stop may be made.
struct StopPlace {
  bool out = false;
  double md = 0;        ///< [m]
  double toolface = 0;  ///< as the tool comes there [rad]
};

/// Of what run StopInformation is made, and how.
struct InformationOptions {
  /// What is left of a run of which so much is known; null: a whole one. Its end is that of the way
  /// so far and of the way left together.
  const RunSoFar* so_far = nullptr;
  bool with_faults = true;  ///< else faults() is empty
  KnotLength knots = {};
};

/// A fault's signature in one unknown: y, of unit variance before the run.
struct HiddenFault {
  double unit = 1;       ///< of the cause, that y = 1 is
  double size = 1;       ///< of CauseSpec
  double ln_onsets = 0;  ///< ln of those that are looked at together and are not alike
};

/// What a run without stops knows of its end, of its faults and of what each stop would measure,
/// all together: from there on a plan's value is a matter of small matrices.
///
/// A second of rest at a place is worth two rows, h' x = noise: the Earth's rate across the tool
/// and the gyros' own errors. With all places' rows H, covariance S = H N^-1 H' and C = B N^-1 H'
/// of the end, that of the end after stops is B N^-1 B' - C (S + V)^-1 C' with V the variance of
/// the mean rate, which falls with the time at rest.
class StopInformation {
 public:
  static constexpr int kBasis = 4;  ///< rows a place: rate at the tool, two; the gyros' own, two

  /// solved() is false where the run cannot be linearised. Throws as CheckPlanCase().
  StopInformation(const PlanCase& c, std::span<const StopPlace> places,
                  const InformationOptions& options = {});

  bool solved() const { return solved_; }
  std::size_t places() const { return places_.size(); }
  const StopPlace& place(std::size_t i) const { return places_[i]; }
  std::span<const HiddenFault> faults() const { return faults_; }
  /// Limit of ln of a Bayes factor that is noticed, see Diagnose().
  double ln_limit() const { return ln_limit_; }

  /// Joint covariance of [end, north and east | faults | kBasis rows a place]; of a fault with
  /// another it is left zero.
  const Eigen::MatrixXd& covariance() const { return covariance_; }
  Eigen::Index fault_row(std::size_t i) const { return 2 + static_cast<Eigen::Index>(i); }
  Eigen::Index place_row(std::size_t i) const {
    return 2 + static_cast<Eigen::Index>(faults_.size()) + kBasis * static_cast<Eigen::Index>(i);
  }
  /// From the rows of a place to what rest there measures, the tool turned by `turn` against how it
  /// comes; of unit variance at kRestKnot seconds.
  static Eigen::Matrix<double, 2, kBasis> Mix(double turn);

 private:
  class Sweep;

  bool solved_ = false;
  double ln_limit_ = 0;
  std::vector<StopPlace> places_;
  std::vector<HiddenFault> faults_;
  Eigen::MatrixXd covariance_;
};

/// Places `spacing` apart on the way down and, where it is surveyed, on the way up; both ends too.
std::vector<StopPlace> PlacesEvery(const PlannedWay& way, double spacing);

}  // namespace wellgyro
