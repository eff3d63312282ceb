#include "wellgyro/calibration/apply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/calibration/group_solution_internal.h"
#include "wellgyro/calibration/thermometer.h"

namespace wellgyro {

namespace {

// Adds what the linear part of a group leaves out.
void Complete(const GroupSolution& group, std::span<const RawSample> raw, std::span<ImuSample> out,
              Eigen::Vector3d ImuSample::*u) {
  if (!group.has_fourth() && !group.feels_force() && !group.has_second_order()) return;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    Eigen::Vector3d value = out[i].*u;
    if (group.has_fourth()) value += group.Fourth(raw[i]);
    if (group.feels_force()) value += group.OfForce(out[i].f_T);
    if (group.has_second_order()) value = group.Refine(value);
    out[i].*u = value;
  }
}

}  // namespace

struct SampleCalibrator::State {
  explicit State(const ToolCalibration& model);

  bool Fits(const RawSample& raw) const {
    return raw.n_channels >= channels_needed && raw.n_temperatures >= thermometers_needed;
  }
  bool Changed(const RawSample& raw) const;
  void Prepare(const RawSample& raw);
  void PrepareGroup(const SensorGroup& group, double seconds, GroupSolution& solution);
  void Meet(const RawSample& raw);
  void Heat(const RawSample& raw);
  void CalibrateRun(std::span<const RawSample> raw, std::span<ImuSample> out) const;
  void Stamp(std::span<const RawSample> raw, std::span<ImuSample> out) const;

  ToolCalibration tool;
  std::int32_t channels_needed = 0, thermometers_needed = 0;
  GroupSolution gyro, accel, mag;

  bool prepared = false;
  std::array<float, RawSample::kTemperaturesMax> raw_temperature{};
  std::int32_t period_ns = 0;
  std::vector<double> temperature;      ///< true, of each thermometer [degC]
  std::vector<char> temperature_known;  ///< inside the thermometer's own range
  bool outside = false;
  float shown_temperature = 0;  ///< of the gyros' thermometer, or the first [degC]

  bool heats = false, heating = false;
  std::int32_t session = 0;
  ToolTime heated_to;
};

SampleCalibrator::State::State(const ToolCalibration& model)
    : tool(model),
      temperature(model.thermometers.size(), 0.0),
      temperature_known(model.thermometers.size(), 1) {
  for (const SensorGroup* group : {&tool.gyro, &tool.accel, &tool.mag}) {
    for (int c = 0; c < group->n_channels; ++c) {
      channels_needed = std::max(channels_needed, group->channel[static_cast<std::size_t>(c)] + 1);
    }
    heats = heats || (group->n_channels > 0 && !group->heating.isZero(0));
  }
  for (const ThermometerCalibration& thermometer : tool.thermometers) {
    thermometers_needed = std::max(thermometers_needed, thermometer.channel + 1);
  }
}

bool SampleCalibrator::State::Changed(const RawSample& raw) const {
  // By bits: a reading that is no number is the same as itself.
  using Bits = std::array<std::uint32_t, RawSample::kTemperaturesMax>;
  return raw.stamp.period_ns != period_ns || !prepared ||
         std::bit_cast<Bits>(raw.temperature_raw) != std::bit_cast<Bits>(raw_temperature);
}

void SampleCalibrator::State::PrepareGroup(const SensorGroup& group, double seconds,
                                           GroupSolution& solution) {
  if (group.n_channels == 0) return;
  if (group.thermometer < 0) {
    solution.Prepare(group, 0, seconds);
    return;
  }
  const auto thermometer = static_cast<std::size_t>(group.thermometer);
  const bool inside = solution.Prepare(group, temperature[thermometer], seconds);
  if (!inside || temperature_known[thermometer] == 0) outside = true;
}

void SampleCalibrator::State::Prepare(const RawSample& raw) {
  raw_temperature = raw.temperature_raw;
  period_ns = raw.stamp.period_ns;
  prepared = true;
  for (std::size_t i = 0; i < temperature.size(); ++i) {
    const ThermometerCalibration& thermometer = tool.thermometers[i];
    const Temperature read = TrueTemperature(
        thermometer,
        static_cast<double>(raw.temperature_raw[static_cast<std::size_t>(thermometer.channel)]));
    temperature[i] = read.value;
    temperature_known[i] = read.inside ? 1 : 0;
  }
  outside = false;
  const double seconds = static_cast<double>(std::max(period_ns, 1)) * 1e-9;
  PrepareGroup(tool.gyro, seconds, gyro);
  PrepareGroup(tool.accel, seconds, accel);
  PrepareGroup(tool.mag, seconds, mag);
  const int shown = std::max(tool.gyro.thermometer, 0);
  shown_temperature =
      temperature.empty() ? 0 : static_cast<float>(temperature[static_cast<std::size_t>(shown)]);
}

void SampleCalibrator::State::Heat(const RawSample& raw) {
  const ToolTime now = raw.stamp.tool_time;
  const bool follows = heating && raw.stamp.session == session && now > heated_to;
  const double seconds = follows ? (now - heated_to).seconds() : 0;
  const auto heat = [&](const SensorGroup& group, GroupSolution& solution) {
    if (group.n_channels == 0 || group.heating.isZero(0)) return;
    if (follows) {
      solution.Heat(group, seconds);
    } else if (!heating || raw.stamp.session != session) {
      solution.Settle();
    }
  };
  heat(tool.gyro, gyro);
  heat(tool.accel, accel);
  heat(tool.mag, mag);
  if (follows || !heating || raw.stamp.session != session) heated_to = now;
  session = raw.stamp.session;
  heating = true;
}

// Makes ready for a sample at its temperature and time.
void SampleCalibrator::State::Meet(const RawSample& raw) {
  const bool changed = Changed(raw);
  // A temperature holds from the sample that brings it: the time before it was the old one's.
  if (heats && prepared) Heat(raw);
  if (changed) Prepare(raw);
  if (heats && !heating) Heat(raw);
}

void SampleCalibrator::State::Stamp(std::span<const RawSample> raw,
                                    std::span<ImuSample> out) const {
  const bool has_gz = gyro.n_channels() > 2, has_mag = mag.n_channels() > 0, flag = outside;
  const float shown = shown_temperature;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    SampleStamp& stamp = out[i].stamp = raw[i].stamp;
    stamp.temperature_outside = stamp.temperature_outside || flag;
    stamp.temperature = shown;
    out[i].has_gz = has_gz;
    out[i].has_mag = has_mag;
  }
}

// Samples at one temperature.
void SampleCalibrator::State::CalibrateRun(std::span<const RawSample> raw,
                                           std::span<ImuSample> out) const {
  Stamp(raw, out);
  const LinearPart of_gyro = gyro.linear(), of_accel = accel.linear(), of_mag = mag.linear();
  for (std::size_t i = 0; i < raw.size(); ++i) {
    out[i].f_T = of_accel(raw[i]);
    out[i].w_IT_T = of_gyro(raw[i]);
    out[i].b_T = of_mag(raw[i]);
  }
  // The force first: the gyros feel it.
  Complete(accel, raw, out, &ImuSample::f_T);
  Complete(gyro, raw, out, &ImuSample::w_IT_T);
  Complete(mag, raw, out, &ImuSample::b_T);
}

SampleCalibrator::SampleCalibrator(const ToolCalibration& tool) {
  if (const auto complaint = FindComplaint(tool)) throw std::invalid_argument(*complaint);
  state_ = std::make_unique<State>(tool);
}

SampleCalibrator::~SampleCalibrator() = default;
SampleCalibrator::SampleCalibrator(SampleCalibrator&&) noexcept = default;
SampleCalibrator& SampleCalibrator::operator=(SampleCalibrator&&) noexcept = default;

std::size_t SampleCalibrator::Apply(std::span<const RawSample> raw, std::span<ImuSample> out) {
  if (out.size() < raw.size()) {
    throw std::invalid_argument(
        fmt::format("out holds {} samples where {} are to be calibrated", out.size(), raw.size()));
  }
  State& state = *state_;
  std::size_t done = 0;
  while (done < raw.size() && state.Fits(raw[done])) {
    state.Meet(raw[done]);
    std::size_t end = done + 1;
    if (!state.heats) {
      while (end < raw.size() && state.Fits(raw[end]) && !state.Changed(raw[end])) ++end;
    }
    state.CalibrateRun(raw.subspan(done, end - done), out.subspan(done, end - done));
    done = end;
  }
  return done;
}

std::optional<double> SampleCalibrator::Parity(const RawSample& raw) const {
  const State& state = *state_;
  if (state.tool.gyro.n_channels != 4 || !state.prepared || !state.Fits(raw)) return std::nullopt;
  ImuSample sample;
  state.CalibrateRun({&raw, 1}, {&sample, 1});
  return state.gyro.Parity(raw, sample.w_IT_T, sample.f_T);
}

std::string SampleCalibrator::WhyNot(const RawSample& raw) const {
  const State& state = *state_;
  if (raw.n_channels < state.channels_needed) {
    return fmt::format("sample {} has {} channels where the tool model needs {}", raw.stamp.seq,
                       raw.n_channels, state.channels_needed);
  }
  return fmt::format("sample {} has {} thermometers where the tool model needs {}", raw.stamp.seq,
                     raw.n_temperatures, state.thermometers_needed);
}

}  // namespace wellgyro
