#pragma once

#include "wellgyro/attitude/filter.h"
#include "wellgyro/attitude/smoother.h"
#include "wellgyro/base/export.h"
#include "wellgyro/record/run_fit.h"
#include "wellgyro/survey/run_adjuster.h"

namespace wellgyro {

struct AdjustmentOptions {
  double knot_seconds = 10;  ///< knots between stations are merged up to this length [s]
  double huber = 4;          ///< ties and readings beyond so many sigma count less
  bool use_repeats = true;   ///< depths passed more than once have one direction
};

/// A run adjusted as a whole, with what tells how well it fits.
struct Adjustment : RunFit {
  SmoothedRun run;
};

/// Least squares over all that a run measured: azimuth, inclination and drift at nodes every
/// `knot_seconds` and at every station, and the tool's constant errors.
///
/// Residuals: growth of azimuth between nodes (turn), growth of inclination (lift) against that of
/// the accelerometers, at rest both as the Earth's rate and no growth, azimuths from outside,
/// directions at depths passed twice, priors of all errors. The drift goes on as in the filter. The
/// Earth's rate in `lift` makes the motion itself find north, so that a run without fix or external
/// azimuth gets one wherever it is observable; where no azimuth is known to start from, twelve are
/// tried on a coarse problem. Everything is linear but the Earth's share, whose way between nodes
/// is renewed until it stays, so the covariance is that of the solution, from its normal equations.
/// Near vertical, where the smoother has lost the azimuth and its growth as well, none is given.
/// A run that does not fit has its variances multiplied by chi-square over the degrees of freedom.
/// Time and memory are proportional to the nodes.
/// `sigma_lie`: see RunAdjuster.
WELLGYRO_EXPORT Adjustment AdjustRun(const FilterHistory& history, double sigma_lie,
                                     const AdjustmentOptions& options = {});

/// The same, to hand to a Surveyor.
class WELLGYRO_EXPORT LeastSquaresAdjuster : public RunAdjuster {
 public:
  explicit LeastSquaresAdjuster(const AdjustmentOptions& options = {});
  SmoothedRun Adjust(const FilterHistory& history, std::span<const Increment> increments,
                     double sigma_lie) const override;

 private:
  AdjustmentOptions options_;
};

}  // namespace wellgyro
