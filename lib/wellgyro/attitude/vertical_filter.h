#pragma once

#include <memory>
#include <optional>

#include "wellgyro/attitude/unseen.h"
#include "wellgyro/base/export.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/attitude_sample.h"
#include "wellgyro/record/knot.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/sample.h"

namespace wellgyro {

struct VerticalSetup {
  NoiseCoefficients gyro;
  ErrorPriors errors;
  UnseenHole unseen;
  /// What is given from outside at the begin of a run is the azimuth of the axis, not that of the
  /// reference mark.
  bool start_is_axis = false;
};

/// sin I below which the vertical filter does better than the high-side form:
/// max(500 N_a / g, 50 b_a / g, 2e-3), N_a the accelerometers' noise density and b_a their bias.
/// There the noise of one second is 2e-3 rad of toolface. With a third gyro axis 0.25.
WELLGYRO_EXPORT double SineNearVertical(const ErrorPriors& errors, bool has_gz);

/// The whole rotation R_LT of a moving tool near vertical, where azimuth and toolface are singular
/// and only their sum S = A + T (the gyro toolface) is regular.
///
/// An error-state Kalman filter on attitude, the rate about the tool's axis, and the biases of the
/// transverse gyros and accelerometers; forces enter as vectors, so nothing is singular at I = 0.
/// Where the stream has a third gyro axis it is used, and its bias and scale take the place of the
/// rate.
/// Without one the rate about the axis is a random walk, which gravity shows the less the nearer
/// to vertical: how much it walks is learned from a bank of filters with walks a decade apart,
/// whose likelihoods weigh them; where gravity shows nothing for minutes they are forgotten. Errors
/// grow from the last place where gravity showed the rate.
///
/// It takes over (CutKnot) below sin I = max(500 N_a / g, 50 b_a / g, 2e-3), N_a the
/// accelerometers' noise density and b_a their bias: there the noise of one second is 2e-3 rad of
/// toolface. It gives back a third higher, and runs along from six times that on. Costs some
/// microseconds a sample while it runs; allocates nothing per sample. Markley, "Attitude error
/// representations for Kalman filtering", J. Guidance 26 (2003).
class WELLGYRO_EXPORT VerticalFilter {
 public:
  explicit VerticalFilter(const VerticalSetup& setup);
  ~VerticalFilter();
  VerticalFilter(const VerticalFilter&);
  VerticalFilter& operator=(const VerticalFilter&);
  VerticalFilter(VerticalFilter&&) noexcept;
  VerticalFilter& operator=(VerticalFilter&&) noexcept;

  /// Takes the next sample; `along` at the middle of it. Samples that are late or not finite are
  /// left out. Over time without samples the axis stays and the tool turns on about it as before,
  /// and the covariance widens by what may have changed; beyond a gyro's full scale by as much
  /// again.
  void Push(const ImuSample& sample, const AlongHole& along, const Site& site);

  /// Whether Push would take this sample next: it runs, or here it would begin to.
  bool Wants(const ImuSample& sample) const;

  /// The azimuth of the axis now [rad], with its variance; before, it counts from an arbitrary
  /// zero. What is known of the sum A + T from then on counts from this.
  void SetAzimuth(double azimuth, double variance);

  /// The true azimuth of what this filter's azimuths count from, where known, and its 1-sigma
  /// [rad]: for the Earth's rate. Makes no step in the azimuths of this filter.
  void SetNorth(std::optional<double> azimuth_of_zero, double sigma);

  /// `knot` ends `rest` [s] before the end of the last sample, in a gap after it (negative). Where
  /// this filter does better, its attitude and growths take the place of the knot's own,
  /// Knot::axial tells. Every knot of a run goes through here once, in the order of time.
  void CutKnot(double rest, Knot& knot);

  /// The tool is at rest: it does not turn about its axis either, though near vertical gravity
  /// would not show it. What was learned of its rolling is forgotten with that.
  void Hold();
  /// The tool is told to turn about its axis.
  void Release();

  bool running() const;
  bool ready() const;  ///< a force has been taken
  /// At the last knot, counted from the filter's own zero, not from north [rad].
  double azimuth_from_zero() const;
  /// At the end of the last sample: all that is known, tool's errors by their priors.
  AttitudeSample attitude() const;
  /// Rate about the tool's axis against inertial space, and its sigma [rad/s].
  double axial_rate() const;
  double sigma_axial_rate() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace wellgyro
