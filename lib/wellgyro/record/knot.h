#pragma once

#include <complex>
#include <cstdint>

#include <Eigen/Core>

#include "wellgyro/base/time.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/quality.h"

namespace wellgyro {

/// What the sensors said between two instants of a run, integrated at full rate and free of any
/// assumption about azimuth: the door between the per-sample work and everything that estimates
/// azimuth from it (filter, smoother, adjustment of the whole run).
///
/// With W = w_x + i w_y the inertial transverse rate, T the toolface, w_h + i w_r = W e^{iT}, and
/// I the inclination, the azimuth over the interval grows by
///   turn + integral of [cos A cot I (W_e cos L + ...) + W_e sin L + transport],
/// and by the sensitivities below times the errors of the sensors (estimate = truth + error, and
/// the sensitivity is d(azimuth turn)/d(sensor error) with the error left uncorrected).
///
/// turn, cot, lift and everything derived from them cover the sampled time, seconds - gap_seconds:
/// how the hole turned during a gap is unknown, with the Earth's part of it.
struct Knot {
  /// Sensor errors whose effect on the azimuth turn is kept, in this order.
  enum Source {
    kGyroBiasX,       ///< [rad/s]
    kGyroBiasY,       ///< [rad/s]
    kMassUnbalance,   ///< drift of x by m f_x, of y by m f_y [rad/s per m/s^2]
    kQuadrature,      ///< drift of x by q f_y, of y by -q f_x [rad/s per m/s^2]
    kGyroScaleX,      ///< [1]
    kGyroScaleY,      ///< [1]
    kMisalignmentX,   ///< rate about z seen by x [rad]
    kMisalignmentY,   ///< rate about z seen by y [rad]
    kToolfaceOffset,  ///< toolface read too large [rad]
    kTimeSkew,        ///< toolface read too late, so that T reads T + T' skew [s]
    kAccelBiasX,      ///< [m/s^2]
    kAccelBiasY,      ///< [m/s^2]
    kAccelBiasZ,      ///< [m/s^2]
    kSources
  };
  using SourceVector = Eigen::Matrix<double, kSources, 1>;

  ToolTime time;           ///< end of the interval, to the nanosecond below
  UtcTime utc;             ///< the same instant by the clock tie
  AlongHole along;         ///< at `time`
  double seconds = 0;      ///< length of the interval
  double inclination = 0;  ///< at `time`, gyro-aided [rad]
  double toolface = 0;     ///< at `time` [rad], (-pi, pi]
  double turn = 0;         ///< integral of -Re(W e^{iT}) / sin I [rad]
  double cot = 0;          ///< integral of cot I [s]
  /// Near vertical in place of cot: the growth has W_e cos L Re[e^{iA} axial_cot] instead, with the
  /// azimuth at the knot's begin [s].
  std::complex<double> axial_cot = 0;
  double lift = 0;  ///< integral of Im(W e^{iT}), the inertial inclination change [rad]
  double roll = 0;  ///< change of the unwrapped toolface [rad]
  double inclination_accel = 0;  ///< mean over the interval of accelerometer inclination [rad]
  double sigma_inclination = 0;  ///< of `inclination`, from noise alone [rad]
  double sigma_inclination_accel = 0;  ///< of `inclination_accel`, from noise alone [rad]
  bool level = true;  ///< `inclination_accel` counts: no accelerometer stood at full scale
  SourceVector d_turn = SourceVector::Zero();         ///< d turn / d source
  SourceVector d_lift = SourceVector::Zero();         ///< d lift / d source
  SourceVector d_inclination = SourceVector::Zero();  ///< d inclination (at `time`) / d source
  double white_turn = 0;  ///< integral of 1 / sin^2 I [s]: times N^2 the variance of `turn`
  double toolface_noise_turn = 0;  ///< variance of `turn` from accelerometer noise [rad^2]
  bool still = false;              ///< the whole interval was at rest
  bool vertical = false;  ///< nowhere in it was the inclination enough for this form to hold
  /// At `time` so near vertical that only the gyro toolface S = azimuth + toolface is regular: what
  /// grows by `turn` is then S - `toolface`, which is the azimuth but for the error of `toolface`.
  /// d_turn and toolface_noise_turn lead from the one to the other where a stretch begins or ends.
  bool axial = false;
  /// There too the toolface is known, so that `lift`, `inclination_accel` and what belongs to them
  /// are as everywhere; elsewhere in a stretch they follow from `inclination`.
  bool lifts = false;
  double var_sum = 0;               ///< if axial, of S from noise, which comes and goes [rad^2]
  std::complex<double> rolled = 0;  ///< if it lifts, integral of e^{iT} [s]
  /// Likewise of cos T and sin T times d toolface / d source: errors that turn with the tool meet
  /// that of the toolface, which does too, in the second order. See SecondOrderOf().
  Eigen::Matrix<double, 2, kSources> rolled_toolface = Eigen::Matrix<double, 2, kSources>::Zero();
  SourceVector d_toolface = SourceVector::Zero();  ///< d toolface (at `time`) / d source; if axial
  double var_toolface = 0;                         ///< of `toolface` from noise alone [rad^2]
  /// Variance from noise of the azimuth less that of S - `toolface`, if axial [rad^2].
  double var_azimuth_beyond = 0;
  /// At an axial knot or the first one behind, what toolface_noise_turn of so many before it has to
  /// be multiplied by, now that gravity has told how the tool turned meanwhile.
  double axial_noise_share = 1;
  int axial_noise_knots = 0;
  double gap_seconds = 0;  ///< of the interval, without samples
  /// How far the hole may have turned unseen, each way, 1-sigma: while samples were missing, or
  /// beyond what a sensor at full scale read [rad].
  double unseen = 0;
  /// Variance which that adds since the run's begin: a hole goes on as it does, so that what was
  /// missed of it shortly before adds in amplitude [rad^2].
  double var_unseen = 0;
  std::int64_t seq_begin = 0;     ///< first sample
  std::int64_t seq_end = 0;       ///< exclusive
  std::int64_t samples_lost = 0;  ///< in that range
  Quality quality = Quality::kGood;
};

}  // namespace wellgyro
