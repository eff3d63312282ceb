#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include <Eigen/Core>

#include "wellgyro/attitude/filter.h"
#include "wellgyro/attitude/filter_state.h"
#include "wellgyro/math/drift.h"
#include "wellgyro/record/knot.h"
#include "wellgyro/record/unknown_angle.h"

namespace wellgyro {

/// What the linear algebra takes for "nothing known": wide enough that a fix learns nothing about
/// the other errors from it (1e-4 of what a turn uncertain by 0.1 rad would tell), small enough to
/// keep digits.
inline constexpr double kDiffuseAzimuthVariance = 100;

/// What leaves so much of an unknown azimuth's variance, or less, tells of it.
inline constexpr double kTellsOfAzimuth = 0.5;

/// Which error stands where in the state; -1 where its prior is zero. Azimuth is state 0.
struct FilterLayout {
  struct Axis {
    int level = -1, markov = -1, ramp = -1;
  };
  std::array<Axis, 2> drift;
  /// Of the other sources of a Knot; -1 for the two gyro biases, which are in `drift`.
  std::array<int, Knot::kSources> source;
  int latitude = -1;
  int inclination = -1;
  int size = 1;
};

/// Variance of an inclination that is not followed so far [rad^2].
inline constexpr double kNoInclination = 1e-2;

inline Knot::Source BiasOf(std::size_t axis) {
  return axis == 0 ? Knot::kGyroBiasX : Knot::kGyroBiasY;
}

/// Sensitivities to the sources, with a sign, into the rows of the state they belong to.
template <class Row>
void Load(const FilterLayout& layout, const Knot::SourceVector& d, double sign, Row&& row) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double value = sign * d[BiasOf(axis)];
    if (layout.drift[axis].level >= 0) row[layout.drift[axis].level] += value;
    if (layout.drift[axis].markov >= 0) row[layout.drift[axis].markov] += value;
  }
  for (int source = 0; source < Knot::kSources; ++source) {
    const int at = layout.source[static_cast<std::size_t>(source)];
    if (at >= 0) row[at] += sign * d[source];
  }
}

FilterLayout LayoutOf(const FilterSetup& setup);
DriftCoefficients DriftOf(const FilterSetup& setup);

/// inclination' = row x + offset + white, from the errors at the interval's begin.
struct FilterRise {
  FilterVector row;
  double offset = 0;
  double white = 0;  ///< variance [rad^2]
};

/// x' = Phi x + c + w over one knot, with Phi = D Phi_A: the azimuth first (row 0 is `row`), from
/// the drift at the interval's begin, then the drift (level += seconds ramp, Markov *= decay).
struct FilterTransition {
  FilterVector row;
  double offset = 0;  ///< azimuth' = row x + offset
  double seconds = 0;
  double decay = 1;
  double white = 0;              ///< variance added to azimuth'
  std::array<double, 2> gain{};  ///< of the drift of x and y in the azimuth, which mixes them
  FilterRise rise;
};

/// M <- Phi M, and M <- Phi' M.
template <class Matrix>
void ApplyTransition(const FilterLayout& layout, const FilterTransition& t, Matrix* m) {
  const auto risen = (t.rise.row.transpose() * *m).eval();
  m->row(0) = (t.row.transpose() * *m).eval();
  m->row(layout.inclination) = risen;
  for (const auto& axis : layout.drift) {
    if (axis.ramp >= 0) m->row(axis.level) += t.seconds * m->row(axis.ramp);
    if (axis.markov >= 0) m->row(axis.markov) *= t.decay;
  }
}
template <class Matrix>
void ApplyTransposed(const FilterLayout& layout, const FilterTransition& t, Matrix* m) {
  for (const auto& axis : layout.drift) {
    if (axis.ramp >= 0) m->row(axis.ramp) += t.seconds * m->row(axis.level);
    if (axis.markov >= 0) m->row(axis.markov) *= t.decay;
  }
  const auto first = m->row(0).eval(), risen = m->row(layout.inclination).eval();
  m->row(0).setZero();
  m->row(layout.inclination).setZero();
  *m += t.row * first + t.rise.row * risen;
}

/// One scalar measurement y = h x + white, as it was taken.
struct FilterMeasurement {
  FilterVector h;
  double value = 0;
  double variance = 0;
  FilterVector gain;      ///< filled by FilterCore::Take
  double innovation = 0;  ///< the same
  double innovation_variance = 0;
};

/// Azimuth about which the still knots of one window are made linear.
struct StillWindowPoint {
  double azimuth = 0;
  double variance = 0;  ///< of the azimuth: how far it may be from there [rad^2]
  double seconds = 0;   ///< of all knots of the window
};

/// The two measurements that a still knot makes: rates about the high side and about the right.
struct StillMeasurements {
  FilterMeasurement turn, lift;
};

/// What the knots before leave behind of the place and of the path.
struct FilterPlace {
  double latitude = 0;
  double height = 0;
  bool any_knot = false;
  double inclination = 0;  ///< at the last knot
  AlongHole along;         ///< there
};

/// Speed over the knot; depths at both ends are better than a derivative at one [m/s].
double MeanSpeed(const Knot& knot, const FilterPlace& before);
double MeanInclination(const Knot& knot, const FilterPlace& before);

/// One knot's azimuth growth, less the share of the errors, and its slopes.
struct AzimuthGrowth {
  double growth = 0;
  double by_azimuth = 0;  ///< d growth / d(azimuth at the begin)
  double by_latitude = 0;
  double by_inclination = 0;  ///< of an error of the inclination in the Earth's share alone
};

/// Growth of the azimuth state over a knot at rest: none, unless the toolface it is held against
/// was read anew.
double StillGrowth(const Knot& knot);

/// Mid-point rule with the mean of cos A over the turn, so that a long turn counts rightly; good to
/// the product of the changes of cot I and A over the knot. `azimuth` holds at the knot's begin, or
/// with `backwards` at its end.
AzimuthGrowth GrowthOver(const Knot& knot, const FilterPlace& before, const Site& site,
                         double azimuth, bool backwards);

/// Variance of an azimuth that nothing has told of yet: the Earth's rate may have made it small in
/// the algebra, where it links the azimuth to what comes.
inline double Shown(double variance, bool diffuse) {
  return diffuse ? std::max(variance, kDiffuseAzimuthVariance) : variance;
}

/// State and covariance at one knot, and how they go on: the one forward pass that filter and
/// smoother share. A value: copying it is a snapshot.
class FilterCore {
 public:
  explicit FilterCore(const FilterSetup& setup);

  /// To the end of `knot`, made linear about `azimuth_begin`. `nominal_end`, where there is one, is
  /// the azimuth to start again from when nothing is known of it any more.
  FilterTransition Step(const Knot& knot, double azimuth_begin, std::optional<double> nominal_end);

  /// What the last knot, at rest, says, made linear about `azimuth`.
  StillMeasurements AtRest(const Knot& knot, const StillWindowPoint& about) const;

  FilterMeasurement OfAzimuth(double azimuth, double variance) const;

  /// What the accelerometers say of the inclination over the last knot, where the filter follows
  /// that: near vertical, where an azimuth that is off turns the Earth's rate into an error of the
  /// azimuth which feeds itself, and only how the inclination grows holds it.
  std::optional<FilterMeasurement> Level(const Knot& knot) const;

  void Take(FilterMeasurement* m);

  /// From here on cross() is E[x_here x_now'].
  void BeginStation() { cross_ = covariance_; }

  void SetAzimuth(double azimuth) { state_[0] = azimuth; }
  const FilterSetup& setup() const { return setup_; }
  const FilterLayout& layout() const { return layout_; }
  const FilterPlace& place() const { return place_; }
  const FilterVector& state() const { return state_; }
  const FilterMatrix& covariance() const { return covariance_; }
  const FilterMatrix& cross() const { return cross_; }
  double azimuth() const { return state_[0]; }
  /// Of the azimuth: see Shown().
  double variance() const { return Shown(covariance_(0, 0), diffuse_); }
  bool azimuth_known() const { return variance() < kUnknownAngleVariance; }
  /// Nothing has told of it yet.
  bool azimuth_diffuse() const { return diffuse_; }
  /// covariance(), of which an azimuth that is unknown is as unknown as it was.
  FilterMatrix shown_covariance() const;

 private:
  FilterTransition TransitionOver(const Knot& knot, double azimuth_begin) const;
  bool Follows(const Knot& knot) const;
  Knot::SourceVector Errors() const;
  FilterRise RiseOver(const Knot& knot, double azimuth_begin, double azimuth_growth) const;
  void Rise(const Knot& knot, double azimuth_begin, FilterTransition* t);
  double WhiteVariance(const Knot& knot) const;
  void Propagate(const Knot& knot, const FilterTransition& t);

  FilterSetup setup_;
  FilterLayout layout_;
  DriftCoefficients drift_;
  FilterVector state_;
  FilterMatrix covariance_;
  FilterMatrix cross_;  // empty before the first station
  FilterPlace place_;
  bool diffuse_ = true;
  // How the inclination grew over the last knot, by the errors at its begin, where it is followed.
  bool follows_ = false;
  FilterRise rise_;
};

using AttitudeRows = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kFilterStatesMax>;

/// d(inclination, azimuth, toolface)/dx at the knot, where a reading less its rows x is the truth.
AttitudeRows RowsOf(const FilterLayout& layout, const Knot& knot, double gravity);

/// The attitude at `knot`: `estimate` is rows x, `cov` its covariance; bounded by that of a flat
/// distribution where nothing is known.
AttitudeSample AttitudeOf(const Knot& knot, const Eigen::Vector3d& estimate,
                          const Eigen::Matrix3d& cov, const NoiseCoefficients& gyro);

/// The station at `knot`, its covariances being those of filter or smoother.
StationState StationOf(std::size_t epoch, const Knot& knot, const AttitudeSample& attitude,
                       const AttitudeRows& rows, const FilterMatrix& cov, const FilterMatrix& cross,
                       const NoiseCoefficients& gyro);

/// The part of a knot's growth that comes after a fix which holds inside the knot.
double GrowthSince(const Knot& knot, const NorthFix& fix, double growth_of_knot);

}  // namespace wellgyro
