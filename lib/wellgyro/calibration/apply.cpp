#include "wellgyro/calibration/apply.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/calibration/group_solution_internal.h"
#include "wellgyro/calibration/thermometer.h"

namespace wellgyro {

struct SampleCalibrator::State {
  explicit State(const ToolCalibration& model);

  bool Fits(const RawSample& raw) const {
    return raw.n_channels >= channels_needed && raw.n_temperatures >= thermometers_needed;
  }
  bool Changed(const RawSample& raw) const;
  void Prepare(const RawSample& raw);
  void PrepareGroup(const SensorGroup& group, double seconds, GroupSolution& solution);
  void Heat(const RawSample& raw);
  void Calibrate(const RawSample& raw, ImuSample& out) const;

  ToolCalibration tool;
  std::int32_t channels_needed = 0, thermometers_needed = 0;
  GroupSolution gyro, accel, mag;

  bool prepared = false;
  std::array<float, RawSample::kTemperaturesMax> raw_temperature{};
  std::int32_t period_ns = 0;
  std::vector<double> temperature;      ///< true, of each thermometer [degC]
  std::vector<char> temperature_known;  ///< inside the thermometer's own range
  bool outside = false;

  bool heats = false, heating = false;
  std::int32_t session = 0;
  ToolTime heated_to;
};

SampleCalibrator::State::State(const ToolCalibration& model)
    : tool(model),
      temperature(model.thermometers.size(), 0.0),
      temperature_known(model.thermometers.size(), 1) {
  for (const SensorGroup* group : {&tool.gyro, &tool.accel, &tool.mag}) {
    for (int c = 0; c < group->n_channels; ++c)
      channels_needed = std::max(channels_needed, group->channel[static_cast<std::size_t>(c)] + 1);
    heats = heats || (group->n_channels > 0 && !group->heating.isZero(0));
  }
  for (const ThermometerCalibration& thermometer : tool.thermometers)
    thermometers_needed = std::max(thermometers_needed, thermometer.channel + 1);
}

bool SampleCalibrator::State::Changed(const RawSample& raw) const {
  if (!prepared || raw.stamp.period_ns != period_ns) return true;
  for (std::size_t i = 0; i < static_cast<std::size_t>(thermometers_needed); ++i) {
    if (raw.temperature_raw[i] != raw_temperature[i]) return true;
  }
  return false;
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

void SampleCalibrator::State::Calibrate(const RawSample& raw, ImuSample& out) const {
  out.stamp = raw.stamp;
  out.stamp.temperature_outside = raw.stamp.temperature_outside || outside;
  if (!temperature.empty()) {
    const int of_gyro = std::max(tool.gyro.thermometer, 0);
    out.stamp.temperature = static_cast<float>(temperature[static_cast<std::size_t>(of_gyro)]);
  }
  out.f_T = accel.n_channels() > 0 ? accel.Solve(raw) : Eigen::Vector3d::Zero();
  out.w_IT_T = gyro.n_channels() > 0 ? gyro.Solve(raw, out.f_T) : Eigen::Vector3d::Zero();
  out.b_T = mag.n_channels() > 0 ? mag.Solve(raw) : Eigen::Vector3d::Zero();
  out.has_gz = gyro.n_channels() > 2;
  out.has_mag = mag.n_channels() > 0;
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
  for (std::size_t i = 0; i < raw.size(); ++i) {
    if (!state.Fits(raw[i])) return i;
    const bool changed = state.Changed(raw[i]);
    // A temperature holds from the sample that brings it: the time before it was the old one's.
    if (state.heats && state.prepared) state.Heat(raw[i]);
    if (changed) state.Prepare(raw[i]);
    if (state.heats && !state.heating) state.Heat(raw[i]);
    state.Calibrate(raw[i], out[i]);
  }
  return raw.size();
}

std::optional<double> SampleCalibrator::Parity(const RawSample& raw) const {
  const State& state = *state_;
  if (state.tool.gyro.n_channels != 4 || !state.prepared || !state.Fits(raw)) return std::nullopt;
  ImuSample sample;
  state.Calibrate(raw, sample);
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
