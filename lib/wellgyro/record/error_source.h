#pragma once

#include <Eigen/Core>

namespace wellgyro {

/// Constant errors of a tool that the estimator carries beside the attitudes, in this order
/// (reading = truth + error).
enum ErrorSource {
  kGyroBiasX,            ///< [rad/s]
  kGyroBiasY,            ///< [rad/s]
  kMassUnbalance,        ///< rate of x reads m f_x more, of y m f_y [rad/s per m/s^2]
  kQuadrature,           ///< rate of x reads q f_y more, of y -q f_x [rad/s per m/s^2]
  kGyroScaleX,           ///< [1]
  kGyroScaleY,           ///< [1]
  kMisalignmentX,        ///< rate about z seen by x [rad]
  kMisalignmentY,        ///< rate about z seen by y [rad]
  kToolfaceOffset,       ///< accelerometers read the toolface too large against the gyros [rad]
  kTimeSkew,             ///< accelerometers stamped too early against the gyros [s]
  kAccelBiasX,           ///< [m/s^2]
  kAccelBiasY,           ///< [m/s^2]
  kAccelBiasZ,           ///< [m/s^2]
  kAccelScaleX,          ///< [1]
  kAccelScaleY,          ///< [1]
  kAccelScaleZ,          ///< [1]
  kAccelMisalignmentX,   ///< force along z seen by x [rad]
  kAccelMisalignmentY,   ///< force along z seen by y [rad]
  kAccelShear,           ///< force along y seen by x, and as much of x by y [rad]
  kAccelMisalignmentZX,  ///< force along x seen by z [rad]
  kAccelMisalignmentZY,  ///< force along y seen by z [rad]
  kGyroBiasZ,            ///< of a third gyro axis [rad/s]
  kGyroScaleZ,           ///< of a third gyro axis [1]
  kGyroMisalignmentZX,   ///< rate about x seen by a third gyro axis [rad]
  kGyroMisalignmentZY,   ///< rate about y seen by a third gyro axis [rad]
  kGyroShear,            ///< rate about y seen by x, and as much of x by y [rad]
  kUnbalanceDifference,  ///< rate of x reads s f_x more, of y -s f_y [rad/s per m/s^2]
  kQuadratureSum,        ///< rate of x reads t f_y more, of y t f_x [rad/s per m/s^2]
  /// Second order of the accelerometers: kAccelSecondOrder + 6 i + p is what accelerometer i (x, y,
  /// z) reads per unit of product p of forces (xx, yy, zz, xy, yz, zx) [1/(m/s^2)].
  kAccelSecondOrder,
  kErrorSources = kAccelSecondOrder + 18
};
using ErrorVector = Eigen::Matrix<double, kErrorSources, 1>;
using ErrorMatrix = Eigen::Matrix<double, kErrorSources, kErrorSources>;

/// The first kTurnSources change what the gyros say of a turn, the next kForceSources the force.
inline constexpr int kTurnSources = kAccelBiasX, kForceSources = kGyroBiasZ - kAccelBiasX;
/// Those of the accelerometers' second order.
inline constexpr int kSecondOrderSources = kErrorSources - kAccelSecondOrder;

/// Errors of a whole run, at most: of the tool, each with its change, a ramp of three gyros,
/// latitude, gravity, its gradient, the swing's frequency and the scale of depth.
inline constexpr int kRunErrorsMax = 2 * kErrorSources + 8;

}  // namespace wellgyro
