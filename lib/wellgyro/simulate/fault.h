#pragma once

#include <cstdint>
#include <limits>

namespace wellgyro {

/// One thing that goes wrong in a simulated run, in the samples or the depth marks themselves,
/// beside the tool's errors. It acts from `begin` to `end`, counted from the begin of the run.
struct SimulatedFault {
  enum class Cause : std::uint8_t {
    kGyroStep,          ///< size added to a gyro [rad/s]
    kGyroRamp,          ///< size a second added to a gyro [rad/s^2]
    kGyroTemperature,   ///< a gyro follows 40 K up and down between begin and end [rad/s]
    kGyroScale,         ///< [1]
    kGyroMisalignment,  ///< z into a gyro [rad]
    kMassUnbalance,     ///< [rad/s per m/s^2]
    kQuadrature,        ///< [rad/s per m/s^2]
    kAccelBias,         ///< [m/s^2]
    kAccelScale,        ///< [1]
    kToolfaceSlip,      ///< accelerometers turned against the gyros [rad]
    kTimeSkew,          ///< accelerometers read later than their stamp [s]
    kLatitude,          ///< of the well less that of the simulation's [earth] [rad]
    kSamplesLost,       ///< so much of the run is lost and its gap closed up by the stamps [s]
    kGyroSpike,         ///< one sample, and again every `period` [rad/s]
    kAccelSpike,        ///< one sample, and again every `period` [m/s^2]
    kGyroNoise,         ///< times the tool's own white noise [1]
    kAccelNoise,        ///< times the tool's own white noise [1]
    kRestCreep,      ///< the tool tilts about its y axis at this rate, and back at the end [rad/s]
    kRestTurn,       ///< the tool turns about its axis, within 10 s of begin [rad]
    kSwing,          ///< the tool swings about its y axis by size, every `period` [rad]
    kDepthStep,      ///< added to the marks [m]
    kDepthSlip,      ///< marks lose size, evenly from begin to end, and stay behind [m]
    kDepthScale,     ///< of the marks, from their begin on [1]
    kDepthLag,       ///< marks tell where the tool was so long ago [s]
    kDepthFrozen,    ///< marks repeat the depth at begin
    kMagneticTurn,   ///< the field is turned about gravity [rad]
    kGyroStuck,      ///< an axis repeats its value at begin
    kAccelStuck,     ///< an axis repeats its value at begin
    kGyroDead,       ///< an axis reads nothing
    kAccelDead,      ///< an axis reads nothing
    kGyroInverted,   ///< an axis has the other sign
    kAccelInverted,  ///< an axis has the other sign
    kGyrosSwapped,   ///< x and y
    kAccelsSwapped,  ///< x and y
    kGyroUnit,       ///< all gyros times size, as 57.3 for deg/s taken as rad/s [1]
    kVibration,      ///< of amplitude size along an axis, every `period` [m/s^2]
    kWhirl,          ///< the axis goes round a cone of half angle size, every `period` [rad]
    kUtcStep,        ///< added to the samples' UTC [s]
  };

  Cause cause = Cause::kGyroStep;
  int axis = 0;                                          ///< 0 x, 1 y, 2 z, where it has one
  double begin = 0;                                      ///< [s]
  double end = std::numeric_limits<double>::infinity();  ///< [s]
  double size = 0;                                       ///< in SI, see the cause
  double period = 0;                                     ///< where it repeats [s]; 0: once
};

}  // namespace wellgyro
