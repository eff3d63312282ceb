#pragma once

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/record/along_hole.h"

namespace wellgyro {

/// Variance of an observed inclination from noise: of the accelerometers, of the gyros, and of the
/// acceleration along the hole, which a track of scattering depths tells and which is taken out of
/// the accelerometers. Carried through the observer's own gains.
///
/// The error of that acceleration is the derivative of an error of speed: over long times it
/// cancels, and of its mean over t seconds only the two ends are left. The two err as a swing of
/// damping 0.3 with the sigmas that AlongHole states: within 0.17 the autocorrelation of a local
/// parabola of weights 1 - u^2 through white marks. An observer that trusts 1 / (c + (a / r)^2) to
/// an acceleration a hears less of one that is scatter, and of that something that does not cancel:
/// statistical linearization (Booton, 1954) of a / (c + (a / r)^2). That scatter beyond r evens out
/// within seconds of the begin is a rule of thumb: there sigma is up to twice too large.
class WELLGYRO_EXPORT LevelNoise {
 public:
  /// Of the inclination while the tool moves and no depth tells how [rad].
  static constexpr double kUnknownForce = 1e-3;
  /// What an observer did over a time that is short against its memory.
  struct Block {
    double seconds = 0;    ///< summed
    double level = 0;      ///< gain on the inclination
    double rate = 0;       ///< gain on its rate, times seconds
    double trust = 0;      ///< mean [1]
    double quiet = 1;      ///< c above
    double reach = 1;      ///< r above [m/s^2]
    double span = 0;       ///< since the observer began [s]
    double per_force = 0;  ///< inclination by acceleration, sin I / g [s^2/m]
    double psd_accel = 0;  ///< of the accelerometers' inclination [rad^2 s]
    double psd_gyro = 0;   ///< of the rate of inclination [rad^2/s]
  };
  void Take(const Block& block, const AlongHole& along);
  /// What scattered so far says nothing of what follows.
  void Break();
  /// The inclination has changed by what nothing told [rad^2].
  void Widen(double variance) { cov_(0, 0) += variance; }
  double variance() const { return cov_(0, 0); }  ///< of the inclination [rad^2]

  /// Of the mean acceleration over `seconds`, by what holds at both ends of them [(m/s^2)^2].
  static double MeanVariance(const AlongHole& begin, const AlongHole& end, double seconds);

 private:
  bool begun_ = false;
  /// Of inclination, of its rate, of speed and acceleration by their sigmas.
  Eigen::Matrix<double, 4, 4, Eigen::DontAlign> cov_ =
      Eigen::Matrix<double, 4, 1>(0, 0, 1, 1).asDiagonal();
};

}  // namespace wellgyro
