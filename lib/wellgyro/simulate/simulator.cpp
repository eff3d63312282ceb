#include "wellgyro/simulate/simulator.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include <fmt/core.h>

#include "wellgyro/simulate/random_stream.h"

namespace wellgyro {
namespace {

// Streams of the simulation's seed beside those of the sensors.
enum TimingStream : std::uint64_t { kJitter = 4000, kDepthNoise = 4001 };
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-9;  // of one period, so that a last sample is not lost

std::int32_t PeriodNs(double imu_hz) {
  if (!(imu_hz >= SimulatedStreams::kImuHzLeast && imu_hz <= SimulatedStreams::kImuHzMost)) {
    throw std::invalid_argument(
        fmt::format("[streams] imu_hz: {} is not between 0.5 and 1e5", imu_hz));
  }
  return static_cast<std::int32_t>(std::lround(1e9 / imu_hz));
}

std::int64_t WholeMicroseconds(double seconds) { return std::llround(seconds * 1e6); }

}  // namespace

Simulator::Simulator(const Simulation& simulation)
    : streams_(simulation.streams),
      tool_(simulation.tool),
      truth_(WithTruth(simulation)),
      sensor_errors_(simulation.tool, simulation.seed),
      faults_(simulation),
      jitter_(RandomStream(simulation.seed, kJitter)),
      depth_noise_(RandomStream(simulation.seed, kDepthNoise)),
      period_ns_(PeriodNs(simulation.streams.imu_hz)) {
  const double drift = tool_.errors.clock_drift;
  if (!(std::abs(drift) < 0.5)) {
    throw std::invalid_argument(fmt::format("[tool] clock_drift: {} is no clock's", drift));
  }
  if (!(streams_.depth_hz >= 0 && streams_.depth_hz <= 1e4)) {
    throw std::invalid_argument(
        fmt::format("[streams] depth_hz: {} is not between 0 and 1e4", streams_.depth_hz));
  }
  const double period = period_ns_ * 1e-9 / (1 + drift);
  sample_count_ = static_cast<std::int64_t>(truth_.seconds() / period + kRounding);
  const double last_mark = truth_.seconds() * streams_.depth_hz + kRounding;
  mark_count_ = streams_.depth_hz > 0 ? static_cast<std::int64_t>(last_mark) + 1 : 0;
}

bool Simulator::Next(SimulatedStep& step) {
  const auto& modes = truth_.plan().modes();
  const auto mode = static_cast<std::size_t>(modes_done_);
  const double mode_time = mode < modes.size() ? modes[mode].time : kNever;
  const double sample_time = samples_done_ < sample_count_ ? SampleTime(samples_done_ + 1) : kNever;
  const double mark_time = marks_done_ < mark_count_ ? MarkTime(marks_done_) : kNever;
  if (mode_time <= std::min(sample_time, mark_time) && mode_time < kNever) {
    step = NextMode();
  } else if (sample_time <= mark_time && sample_time < kNever) {
    step = NextSample();
  } else if (mark_time < kNever) {
    step = NextMark();
  } else {
    return false;
  }
  return true;
}

ToolInfo Simulator::tool_info() const {
  ToolInfo info;
  info.utc = streams_.begin_utc;
  info.session = streams_.session;
  info.run = streams_.run;
  info.tool = streams_.tool;
  info.string_position = 1;
  info.sensor_below_reference = tool_.sensor_below_reference;
  info.asset_serial = "simulated";
  return info;
}

double Simulator::SampleTime(std::int64_t k) const {
  return static_cast<double>(k * period_ns_) * 1e-9 / (1 + tool_.errors.clock_drift);
}

double Simulator::MarkTime(std::int64_t k) const {
  return static_cast<double>(WholeMicroseconds(static_cast<double>(k) / streams_.depth_hz)) * 1e-6;
}

UtcTime Simulator::UtcAt(double time) const {
  return {streams_.begin_utc.ns + WholeMicroseconds(time) * 1000};
}

ToolMode Simulator::NextMode() {
  const ModeChange& change = truth_.plan().modes()[static_cast<std::size_t>(modes_done_)];
  ToolMode mode;
  mode.utc = UtcAt(change.time);
  mode.seq = modes_done_++;
  mode.session = streams_.session;
  mode.run = streams_.run;
  mode.mode = change.mode;
  const double samples = change.time / SampleTime(1);
  mode.imu_seq = static_cast<std::int64_t>(std::ceil(samples - kRounding * (1 + samples)));
  mode.index_position = change.index_position;
  mode.index_angle = change.index_angle;
  return mode;
}

ImuSample Simulator::NextSample() {
  const std::int64_t k = samples_done_++;
  const double begin = SampleTime(k);
  const double jitter = tool_.errors.utc_jitter;
  ImuSample sample;
  sample.stamp.temperature = tool_.temperature;
  if (faults_.empty()) {
    sensor_errors_.Measure(truth_, begin, SampleTime(k + 1), sample);
  } else {
    const double late = faults_.SampledAt(begin) - begin;
    const double taken = begin + late, end = SampleTime(k + 1) + late;
    sensor_errors_.SetErrors(faults_.ErrorsAt(begin));
    sensor_errors_.Measure(truth_, taken, end, sample);
    faults_.Spoil(begin, SampleTime(k + 1), sample);
  }
  SampleStamp& stamp = sample.stamp;
  stamp.tool_time.ns = Duration::Seconds(tool_.errors.clock_offset).ns + k * period_ns_;
  const double stamped = begin + faults_.UtcOffset(begin);
  stamp.utc = UtcAt(jitter > 0 ? stamped + jitter * jitter_.Normal() : stamped);
  stamp.seq = k;
  stamp.session = streams_.session;
  stamp.run = streams_.run;
  stamp.tool = streams_.tool;
  stamp.period_ns = period_ns_;
  stamp.simulated = true;
  return sample;
}

DepthMark Simulator::NextMark() {
  const ToolErrors& e = tool_.errors;
  const std::int64_t k = marks_done_++;
  const double time = MarkTime(k);
  const RunMotion motion = truth_.plan().At(faults_.MarkedAt(time));
  double md = motion.md - tool_.sensor_below_reference;
  if (e.depth_scale != 0) md += e.depth_scale * md;
  md = faults_.MarkMd(time, md + e.depth_offset);
  if (e.depth_noise > 0) md += e.depth_noise * depth_noise_.Normal();
  if (e.depth_resolution > 0) md = std::nearbyint(md / e.depth_resolution) * e.depth_resolution;
  DepthMark mark;
  mark.utc = UtcAt(time);
  mark.seq = k;
  mark.session = streams_.session;
  mark.run = streams_.run;
  mark.kind = DepthKind::kWireline;
  mark.md = md;
  mark.stopped = motion.speed == 0;
  return mark;
}

}  // namespace wellgyro
