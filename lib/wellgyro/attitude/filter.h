#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "wellgyro/attitude/filter_state.h"
#include "wellgyro/base/export.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/knot.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/north_fix.h"

namespace wellgyro {

/// What the filter must know before the first knot.
struct FilterSetup {
  NoiseCoefficients gyro;  ///< of both axes
  ErrorPriors errors;
  Site site;  ///< where the run starts; latitude and height are carried along the hole
  /// True azimuth of the axis at the begin of the first knot [rad]; absent: unknown.
  std::optional<double> start_azimuth;
  double start_sigma = 0;  ///< of start_azimuth [rad]
};

/// One knot as the filter left it.
struct FilterEpoch {
  Knot knot;
  double azimuth = 0;        ///< at knot.time, from what was known then [rad], not wrapped
  double sigma_azimuth = 0;  ///< [rad]
  bool azimuth_known = false;
  bool station = false;
  int fix = -1;  ///< index of the fix whose window this still knot serves; -1: none
};

/// What became of a north fix.
enum class FixUse {
  kUsed,       ///< its azimuth, or the rates of its still knots, entered
  kMirror,     ///< the same with its mirror azimuth, which continuity chose
  kAmbiguous,  ///< not used: nothing tells the azimuth from its mirror, or it is as good as none
  kNoKnot,     ///< not used: no knot covers its time
};

struct FilterFix {
  NorthFix fix;
  FixUse use = FixUse::kUsed;
  double azimuth = 0;     ///< the branch that was used [rad]
  double chi_square = 0;  ///< of that branch against the azimuth before; 0 where unknown
  double closure = 0, sigma_closure = 0;  ///< the same as an angle [rad]
  double about = 0;             ///< where the rates are made linear: `azimuth`, weighed with the
                                ///< azimuth known before [rad]
  double var_about = 0;         ///< of `about` [rad^2]
  bool rates = false;           ///< the still knots of its window enter instead of its azimuth
  bool steady = false;          ///< these stay linear about `about`, whatever comes later
  double seconds = 0;           ///< of these knots; n^2 times that for the n-th steady fix
  double hold = 0;              ///< azimuth as if measured at the window's end, beside its rates,
  double var_hold = 0;          ///< and its variance: what they by themselves lack [rad^2]; 0: none
  std::size_t epoch_begin = 0;  ///< first epoch of the window, and the one at which a plain azimuth
  std::size_t epoch_end = 0;    ///< holds is epoch_end - 1; both 0: before the first knot
};

/// All that a run left: what Smooth() works on. Grows by one epoch a knot.
struct FilterHistory {
  FilterSetup setup;
  std::vector<FilterEpoch> epochs;
  std::vector<FilterFix> fixes;  ///< in the order in which they came, the unused included
};

/// Azimuth with an honest covariance, from knots and north fixes in the order of time.
///
/// An extended Kalman filter on azimuth, drift and the tool's constant errors (notes of Knot give
/// the signs: the azimuth grows by turn - d_turn . errors + Earth + transport). The azimuth is
/// unknown until a start azimuth or a fix gives it, and again after a vertical stretch or when its
/// sigma passes that of a flat distribution, pi/sqrt(3): then azimuth_known is false. At rest the
/// azimuth is held. A fix found in samples enters by the mean rates of its still knots, about its
/// azimuth, so that gyro bias, mass unbalance and the rest correlate it rightly with the drift and
/// with other fixes; any other fix enters as azimuth and cov_attitude(1, 1), taken as independent.
///
/// Rates count for less by what the second order in azimuth may be. Where that is too much, as near
/// horizontal and east-west, a first fix leaves azimuth and variance as they stand in it, and later
/// ones are made linear about the azimuth known before, over all its spread. Errors of the second
/// order are the same in all of them: together they tell hardly more of them than one.
/// Near vertical, where the Earth's rate makes an error of azimuth feed itself within minutes, the
/// filter follows the inclination too: its growth by gyros and Earth, against the accelerometers',
/// holds the azimuth while its sigma is below 30 deg.
/// A first knot with zero `seconds` only says where the run begins. One filter for one run.
class WELLGYRO_EXPORT AzimuthFilter {
 public:
  /// Throws std::invalid_argument naming the field when the setup has a negative or non-finite
  /// number or no site.
  explicit AzimuthFilter(const FilterSetup& setup);
  ~AzimuthFilter();
  AzimuthFilter(AzimuthFilter&&) noexcept;
  AzimuthFilter& operator=(AzimuthFilter&&) noexcept;

  /// Carries the state to knot.time; the result is what is known there now. Throws
  /// std::invalid_argument when the knot does not end after the one before.
  const AttitudeSample& Step(const Knot& knot);

  /// Takes a fix once the knots up to its end have been stepped, also much later, between knots, or
  /// (external) at the start; the knots since are worked again, their stations with them. Never
  /// rejects: chi_square says how well it agrees. A fix with a mirror azimuth is used when the
  /// costs of its two branches against the azimuth known before differ by more than 9.
  FilterFix Update(const NorthFix& fix);

  /// Makes the last knot a station, for position covariance and for Smooth().
  /// Throws std::logic_error before the first knot. The reference holds until the next call.
  const StationState& MarkStation();

  /// After the last Step or Update.
  const AttitudeSample& attitude() const;
  /// The marked stations, in the order of time, from knots and fixes up to each.
  const std::vector<StationState>& stations() const;
  const FilterHistory& history() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace wellgyro
