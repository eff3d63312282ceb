#pragma once

#include <cstdint>
#include <memory>

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
  double gap_rate = 1.7e-3;  ///< how fast the axis may turn while samples are missing [rad/s]
};

/// The whole rotation R_LT of a moving tool near vertical, where azimuth and toolface are singular
/// and only their sum S = A + T (the gyro toolface) is regular.
///
/// An error-state Kalman filter on attitude, the rate about the tool's axis, and the biases of the
/// transverse gyros and accelerometers; forces enter as vectors, so nothing is singular at I = 0.
/// Where the stream has a third gyro axis it is used, and its bias takes the place of the rate.
/// Without one the rate about the axis is a random walk, which gravity shows the less the nearer
/// to vertical: how much it walks is learned from a bank of filters with walks a decade apart,
/// whose likelihoods weigh them. Errors grow from the last place where gravity showed the rate.
///
/// Meant for inclinations up to some 20 deg; further up it stays right but loses to the high-side
/// form. Costs some microseconds a sample; allocates nothing per sample.
/// Markley, "Attitude error representations for Kalman filtering", J. Guidance 26 (2003).
class WELLGYRO_EXPORT VerticalFilter {
 public:
  explicit VerticalFilter(const VerticalSetup& setup);
  ~VerticalFilter();
  VerticalFilter(const VerticalFilter&);
  VerticalFilter& operator=(const VerticalFilter&);
  VerticalFilter(VerticalFilter&&) noexcept;
  VerticalFilter& operator=(VerticalFilter&&) noexcept;

  /// Takes the next sample; `along` at the middle of it. Samples that are late or not finite are
  /// left out, time without samples widens the covariance.
  void Push(const ImuSample& sample, const AlongHole& along, const Site& site);

  /// The azimuth of the axis now [rad], with its variance; before, it counts from an arbitrary
  /// zero. What is known of the sum A + T from then on counts from this.
  void SetAzimuth(double azimuth, double variance);

  bool ready() const;  ///< a force has been taken
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
