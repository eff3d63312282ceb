#include "wellgyro/simulate/fault_player.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/sinc.h"
#include "wellgyro/simulate/random_stream.h"

namespace wellgyro {
namespace {

using Cause = SimulatedFault::Cause;
using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr std::uint64_t kNoiseStream = 5000;  // a number that no other draw has
// [s], of a turn at rest, and of a creep's way back: over ten knots, as a string turns.
constexpr double kTurnSeconds = 10;

bool Acts(const SimulatedFault& f, double time) { return time >= f.begin && time < f.end; }

bool NeedsPeriod(Cause cause) {
  return cause == Cause::kSwing || cause == Cause::kVibration || cause == Cause::kWhirl;
}

bool NeedsEnd(Cause cause) {
  return cause == Cause::kRestCreep || cause == Cause::kGyroTemperature ||
         cause == Cause::kDepthSlip;
}

void Check(const SimulatedFault& f, std::size_t index) {
  const auto refuse = [index](const char* what) {
    throw std::invalid_argument(fmt::format("fault {}: {}", index + 1, what));
  };
  if (!std::isfinite(f.size)) refuse("its size is no number");
  if (!(f.begin >= 0)) refuse("it begins before the run");
  if (!(f.end > f.begin)) refuse("it ends before it begins");
  if (!(f.axis >= 0 && f.axis <= 2)) refuse("its axis is none of x, y, z");
  if (NeedsPeriod(f.cause) && !(f.period > 0)) refuse("it needs a period");
  if (NeedsEnd(f.cause) && !std::isfinite(f.end)) refuse("it needs an end");
  if (f.period < 0) refuse("its period is negative");
}

/// From 0 at 0 to 1 at 1 with no slope at either end.
double Smooth(double x) {
  const double s = std::clamp(x, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

/// Angle by which a fault turns the tool away from its truth, at `time`.
double AngleAt(const SimulatedFault& f, double time) {
  switch (f.cause) {
    case Cause::kRestCreep: {
      const double whole = f.size * (f.end - f.begin);
      if (time >= f.end) return whole * (1 - Smooth((time - f.end) / kTurnSeconds));
      return f.size * std::max(time - f.begin, 0.0);
    }
    case Cause::kRestTurn:
      return f.size * Smooth((time - f.begin) / kTurnSeconds);
    case Cause::kSwing:
      if (!Acts(f, time)) return 0;
      // In and out over a tenth of the stretch, as a swing has no begin of its own.
      return f.size * std::sin(kTwoPi * (time - f.begin) / f.period) *
             std::min(1.0, (time - f.begin) / (2 * f.period));
    default:
      return 0;
  }
}

/// A step, a ramp [s], or the rise and fall of a temperature as sine squared.
double ShapeOfBias(const SimulatedFault& f, double time) {
  const double since = time - f.begin;
  if (f.cause == Cause::kGyroStep) return 1;
  if (f.cause == Cause::kGyroRamp) return since;
  return std::pow(std::sin(kTwoPi / 2 * since / (f.end - f.begin)), 2);
}

/// Mean of a cosine of the fault's period over a sample.
double MeanOfVibration(const SimulatedFault& f, double begin, double end) {
  const double w = kTwoPi / f.period;
  return (std::cos(w * (begin - f.begin)) - std::cos(w * (end - f.begin))) / (w * (end - begin));
}

}  // namespace

Simulation WithTruth(Simulation simulation) {
  for (const SimulatedFault& f : simulation.faults) {
    if (f.cause == Cause::kLatitude) simulation.earth.latitude += f.size;
  }
  return simulation;
}

FaultPlayer::FaultPlayer(const Simulation& simulation)
    : faults_(simulation.faults),
      held_(faults_.size(), 0.0),
      holds_(faults_.size(), false),
      done_(faults_.size(), 0),
      errors_(simulation.tool.errors),
      noise_(RandomStream(simulation.seed, kNoiseStream)) {
  for (std::size_t i = 0; i < faults_.size(); ++i) Check(faults_[i], i);
}

ToolErrors FaultPlayer::ErrorsAt(double time) const {
  ToolErrors e = errors_;
  for (const SimulatedFault& f : faults_) {
    if (!Acts(f, time)) continue;
    switch (f.cause) {
      case Cause::kGyroStep:
      case Cause::kGyroRamp:
      case Cause::kGyroTemperature:
        e.gyro_bias[f.axis] += f.size * ShapeOfBias(f, time);
        break;
      case Cause::kGyroScale:
        e.gyro_scale[f.axis] += f.size;
        break;
      case Cause::kGyroMisalignment:
        if (f.axis < 2) e.gyro_misalignment[f.axis] += f.size;
        break;
      case Cause::kMassUnbalance:
        e.mass_unbalance += f.size;
        break;
      case Cause::kQuadrature:
        e.quadrature += f.size;
        break;
      case Cause::kAccelBias:
        e.accel_bias[f.axis] += f.size;
        break;
      case Cause::kAccelScale:
        e.accel_scale[f.axis] += f.size;
        break;
      case Cause::kToolfaceSlip:
        e.roll_offset += f.size;
        break;
      case Cause::kTimeSkew:
        e.time_skew += f.size;
        break;
      case Cause::kAccelNoise:
        e.accel_noise *= f.size;
        break;
      default:
        break;
    }
  }
  return e;
}

double FaultPlayer::SampledAt(double time) const {
  double taken = time;
  for (const SimulatedFault& f : faults_) {
    if (f.cause == Cause::kSamplesLost && time >= f.begin) taken += f.size;
  }
  return taken;
}

double FaultPlayer::MarkedAt(double time) const {
  double at = time;
  for (const SimulatedFault& f : faults_) {
    if (!Acts(f, time)) continue;
    if (f.cause == Cause::kDepthLag) at -= f.size;
    if (f.cause == Cause::kDepthFrozen) at = f.begin;
  }
  return std::max(at, 0.0);
}

double FaultPlayer::MarkMd(double time, double md) const {
  for (const SimulatedFault& f : faults_) {
    if (f.cause == Cause::kDepthSlip) {
      md -= f.size * std::clamp((time - f.begin) / (f.end - f.begin), 0.0, 1.0);
    }
    if (!Acts(f, time)) continue;
    if (f.cause == Cause::kDepthStep) md += f.size;
    if (f.cause == Cause::kDepthScale) md += f.size * md;
  }
  return md;
}

double FaultPlayer::UtcOffset(double time) const {
  double offset = 0;
  for (const SimulatedFault& f : faults_) {
    if (f.cause == Cause::kUtcStep && Acts(f, time)) offset += f.size;
  }
  return offset;
}

/// Turns of the tool as a whole, which gyros and accelerometers both feel.
void FaultPlayer::Turn(const SimulatedFault& f, double begin, double end, ImuSample& s) const {
  const double seconds = end - begin;
  if (f.cause == Cause::kWhirl) {
    if (!Acts(f, begin)) return;
    const double w = kTwoPi / f.period, a = w * (begin - f.begin), b = w * (end - f.begin);
    const Vector3d turned =
        f.size * Vector3d(std::cos(b) - std::cos(a), std::sin(b) - std::sin(a), 0);
    const Vector3d mean =
        f.size / (b - a) * Vector3d(std::sin(b) - std::sin(a), std::cos(a) - std::cos(b), 0);
    // R_LT Exp(phi) turns by w - phi x w + phi' - phi x phi' / 2 in its own axes, to the second
    // order in phi'; phi x phi' is along z.
    const Vector3d coning(0, 0, f.size * f.size * w);
    s.w_IT_T += turned / seconds - mean.cross(s.w_IT_T) - coning / 2;
    s.f_T -= mean.cross(s.f_T);
    return;
  }
  const double before = AngleAt(f, begin), after = AngleAt(f, end);
  if (before == 0 && after == 0) return;
  const Vector3d axis = f.cause == Cause::kRestTurn ? Vector3d::UnitZ() : Vector3d::UnitY();
  // Mean of R(-angle) over a sample: along the axis 1, across it that of the mean angle (Simpson),
  // sinc of half the turn shorter. A turn that speeds up by 22 deg/s^2 is 0.02 deg off its middle.
  const double mean_angle = (before + 4 * AngleAt(f, (begin + end) / 2) + after) / 6;
  const Eigen::Matrix3d along = axis * axis.transpose();
  const Eigen::Matrix3d middle = AngleAxisd(-mean_angle, axis).toRotationMatrix();
  const Eigen::Matrix3d mean = along + Sinc((after - before) / 2) * (middle - along);
  s.f_T = mean * s.f_T;
  s.w_IT_T = mean * s.w_IT_T + (after - before) / seconds * axis;
}

/// White noise that makes the gyros' own `size` times as large.
void FaultPlayer::AddNoise(const SimulatedFault& f, double seconds, ImuSample& s) {
  const double more = std::sqrt(std::max(f.size * f.size - 1, 0.0) / seconds);
  for (int i = 0; i < (s.has_gz ? 3 : 2); ++i) {
    s.w_IT_T[i] += more * errors_.gyro_noise.angle_random_walk * noise_.Normal();
  }
}

/// Once, or once a period.
bool FaultPlayer::Strikes(const SimulatedFault& f, std::size_t index, double begin) {
  const double next = f.begin + static_cast<double>(done_[index]) * f.period;
  if ((done_[index] > 0 && f.period == 0) || begin < next) return false;
  ++done_[index];
  return true;
}

/// What one fault makes of what the sensors give.
void FaultPlayer::Sense(const SimulatedFault& f, std::size_t index, double begin, double end,
                        ImuSample& s) {
  const bool gyro = f.cause == Cause::kGyroStuck || f.cause == Cause::kGyroDead ||
                    f.cause == Cause::kGyroInverted || f.cause == Cause::kGyroSpike;
  double& value = gyro ? s.w_IT_T[f.axis] : s.f_T[f.axis];
  switch (f.cause) {
    case Cause::kGyroStuck:
    case Cause::kAccelStuck:
      if (!holds_[index]) held_[index] = value;
      holds_[index] = true;
      value = held_[index];
      break;
    case Cause::kGyroDead:
    case Cause::kAccelDead:
      value = 0;
      break;
    case Cause::kGyroInverted:
    case Cause::kAccelInverted:
      value = -value;
      break;
    case Cause::kGyroSpike:
    case Cause::kAccelSpike:
      if (Strikes(f, index, begin)) value += f.size;
      break;
    case Cause::kGyrosSwapped:
      std::swap(s.w_IT_T.x(), s.w_IT_T.y());
      break;
    case Cause::kAccelsSwapped:
      std::swap(s.f_T.x(), s.f_T.y());
      break;
    case Cause::kGyroUnit:
      s.w_IT_T *= f.size;
      break;
    case Cause::kGyroNoise:
      AddNoise(f, end - begin, s);
      break;
    case Cause::kVibration:
      value += f.size * MeanOfVibration(f, begin, end);
      break;
    case Cause::kMagneticTurn:
      s.b_T = AngleAxisd(f.size, s.f_T.normalized()) * s.b_T;
      break;
    default:
      break;
  }
}

void FaultPlayer::Spoil(double begin, double end, ImuSample& sample) {
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    Turn(faults_[i], begin, end, sample);
    if (faults_[i].cause == Cause::kGyroTemperature && Acts(faults_[i], begin)) {
      const SimulatedFault& f = faults_[i];
      const double part = std::sin(kTwoPi / 2 * (begin - f.begin) / (f.end - f.begin));
      sample.stamp.temperature += static_cast<float>(40 * part * part);
    }
    if (Acts(faults_[i], begin)) Sense(faults_[i], i, begin, end, sample);
  }
  if (!sample.has_gz) sample.w_IT_T.z() = 0;
}

}  // namespace wellgyro
