#include "wellgyro/simulate/run_plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/simulate/require_internal.h"
#include "wellgyro/simulate/smooth_window.h"

namespace wellgyro {
namespace {

// Phase x that passes in a short time, over which sensors are integrated by four points of Gauss:
// the mean of exp(ix) is off by x^8 4!^4 / (9 8!^3) = 5.6e-10 x^8, below rounding for a turn of 0.1
// rad, 2e-12 of the amplitude for a wave of 0.5 rad.
constexpr double kTurnPerShortTime = 0.1;  // [rad]
constexpr double kWavePerShortTime = 0.5;  // [rad]
constexpr double kLongest = 1e7;           // [s], of a run: nothing would ever come of a longer one
constexpr double kShortest = 1e-5;         // [s], which the truth is integrated by

double CommandedRoll(double toolface, double md, RollReference reference, const TruthWell& well) {
  return reference == RollReference::kHighSide ? toolface : toolface + well.PointAt(md).azimuth;
}

/// What an oscillation has turned the tool by, `since` seconds into a move with its speed at `w`.
void AddWave(const RunRoll& wave, double since, const SmoothWindow& w, RunMotion& motion) {
  const double frequency = kTwoPi / wave.period;
  if (wave.rests_there) {
    const double angle = wave.phase + frequency * w.integral;
    motion.roll += wave.amplitude * (std::sin(angle) - std::sin(wave.phase));
    motion.roll_rate += wave.amplitude * frequency * w.value * std::cos(angle);
    return;
  }
  const double s = std::sin(frequency * since + wave.phase);
  const double c = std::cos(frequency * since + wave.phase);
  motion.roll += wave.amplitude * w.value * s;
  motion.roll_rate += wave.amplitude * (w.slope * s + w.value * frequency * c);
}

/// As the file has it: the steps counted from 1.
std::string Named(std::size_t number, const char* key, double value) {
  return fmt::format("[[run.step]] {}: {} {}", number + 1, key, value);
}

}  // namespace

RunPlan::RunPlan(const SimulatedRun& run, const TruthWell& well) {
  Require(run.start_md >= well.begin_md() && run.start_md <= well.end_md(),
          fmt::format("[run] start_md_m: {} is outside the well, {} to {} m", run.start_md,
                      well.begin_md(), well.end_md()));
  end_.md = run.start_md;
  end_.roll = CommandedRoll(run.start_toolface, run.start_md, run.roll_reference, well);
  for (std::size_t i = 0; i < run.steps.size(); ++i) {
    if (const auto* stop = std::get_if<RunStop>(&run.steps[i])) {
      AddStop(*stop, run, well, i);
    } else {
      AddMove(std::get<RunMove>(run.steps[i]), well, i);
    }
  }
  Require(seconds_ <= kLongest,
          fmt::format("[run] takes {} s, more than {} s: a speed is too low or a stop too long",
                      seconds_, kLongest));
  Require(short_time_ >= kShortest,
          fmt::format("[run] changes within {} s, less than {} s: a speed or a roll rate is too "
                      "high, or a ramp, a turn or a roll period too short",
                      short_time_, kShortest));
  std::sort(breaks_.begin(), breaks_.end());
}

void RunPlan::AddLeg(Leg leg) {
  leg.begin = seconds_;
  leg.md = end_.md;
  leg.roll = end_.roll;
  breaks_.insert(breaks_.end(), {leg.begin, leg.begin + leg.seconds});
  if (leg.ramp > 0) {
    breaks_.insert(breaks_.end(), {leg.begin + leg.ramp, leg.begin + leg.seconds - leg.ramp});
  }
  seconds_ += leg.seconds;
  legs_.push_back(leg);
}

void RunPlan::AddTurn(double angle, double turn_seconds) {
  if (angle == 0) return;
  modes_.push_back({.time = seconds_, .mode = ToolMode::Mode::kMoving});
  AddLeg({.seconds = turn_seconds, .turn = angle});
  end_.roll += angle;
  // The quintic step's greatest slope is 15/8 of its mean.
  short_time_ = std::min(short_time_, kTurnPerShortTime * turn_seconds / (1.875 * std::abs(angle)));
}

void RunPlan::AddStop(const RunStop& stop, const SimulatedRun& run, const TruthWell& well,
                      std::size_t number) {
  Require(stop.seconds >= 0 && std::isfinite(stop.seconds),
          Named(number, "stop_s", stop.seconds) + " is no length of time");
  Require(stop.turn_seconds > 0, Named(number, "turn_s", stop.turn_seconds) + " is not positive");
  const double before = end_.roll;
  if (stop.toolface) {
    const double target = CommandedRoll(*stop.toolface, end_.md, run.roll_reference, well);
    AddTurn(WrapPi(target - end_.roll), stop.turn_seconds);
  }
  const std::vector<double> single(1, 0.0);
  const bool indexed = !stop.index_angles.empty();
  const std::vector<double>& angles = indexed ? stop.index_angles : single;
  const double base = end_.roll;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    AddTurn(base + angles[i] - end_.roll, stop.turn_seconds);
    end_.roll = base + angles[i];
    ModeChange change{.time = seconds_, .mode = stop.mode};
    if (indexed) {
      change.index_position = static_cast<std::int32_t>(i);
      change.index_angle = angles[i];
    }
    modes_.push_back(change);
    AddLeg({.seconds = stop.seconds});
  }
  if (stop.turns_back) AddTurn(before - end_.roll, stop.turn_seconds);
}

void RunPlan::AddMove(const RunMove& move, const TruthWell& well, std::size_t number) {
  Require(move.to_md >= well.begin_md() && move.to_md <= well.end_md(),
          Named(number, "to_md_m", move.to_md) +
              fmt::format(" is outside the well, {} to {} m", well.begin_md(), well.end_md()));
  Require(move.speed > 0, Named(number, "speed_mps", move.speed) + " is not positive");
  Require(move.ramp > 0, Named(number, "ramp_s", move.ramp) + " is not positive");
  const bool waves = move.roll.amplitude != 0;
  Require(!waves || move.roll.period > 0,
          Named(number, "roll_period_s", move.roll.period) + " is not positive");
  const double distance = move.to_md - end_.md;
  if (distance == 0) return;
  const double whole = std::max(std::abs(distance) / move.speed, move.ramp);
  modes_.push_back({.time = seconds_, .mode = ToolMode::Mode::kContinuous});
  AddLeg({.seconds = whole + move.ramp,
          .ramp = move.ramp,
          .speed = distance / whole,
          .wave = move.roll});
  end_.md = move.to_md;
  end_.roll += move.roll.rate * whole;
  if (waves && move.roll.rests_there) {
    const double turned = kTwoPi * whole / move.roll.period;
    end_.roll +=
        move.roll.amplitude * (std::sin(move.roll.phase + turned) - std::sin(move.roll.phase));
  }
  if (move.roll.rate != 0) {
    short_time_ = std::min(short_time_, kTurnPerShortTime / std::abs(move.roll.rate));
  }
  if (waves) {
    short_time_ = std::min(short_time_, kWavePerShortTime * move.roll.period / kTwoPi);
  }
  short_time_ = std::min(
      {short_time_, move.ramp / 4, well.shape().detail() / 4 / std::abs(legs_.back().speed)});
}

RunMotion RunPlan::At(double time) const {
  if (legs_.empty() || time >= seconds_) return end_;
  const auto after = std::upper_bound(legs_.begin() + 1, legs_.end(), time,
                                      [](double t, const Leg& leg) { return t < leg.begin; });
  const Leg& leg = *(after - 1);
  RunMotion motion{.md = leg.md, .roll = leg.roll};
  const double x = std::max(time - leg.begin, 0.0);
  if (leg.turn != 0) {
    const SmoothWindow s = SmoothStep(std::min(x / leg.seconds, 1.0));
    motion.roll += leg.turn * s.value;
    motion.roll_rate = leg.turn * s.slope / leg.seconds;
    motion.still = false;
  } else if (leg.speed != 0) {
    const SmoothWindow w = SmoothWindowAt(x, leg.seconds, leg.ramp, leg.ramp);
    motion.md += leg.speed * w.integral;
    motion.speed = leg.speed * w.value;
    motion.acceleration = leg.speed * w.slope;
    motion.roll += leg.wave.rate * w.integral;
    motion.roll_rate = leg.wave.rate * w.value;
    motion.still = false;
    if (leg.wave.amplitude != 0) AddWave(leg.wave, x, w, motion);
  }
  return motion;
}

double RunPlan::NextBreak(double time) const {
  const auto next = std::upper_bound(breaks_.begin(), breaks_.end(), time);
  return next == breaks_.end() ? std::numeric_limits<double>::infinity() : *next;
}

}  // namespace wellgyro
