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

/// Samples that are calibrated side by side, and that are looked at together.
constexpr int kSide = 4;
constexpr std::size_t kRun = 32;

struct HeatingRates {
  std::array<float, kRun> gyro{}, accel{}, mag{};
};

struct Kernels {
  const GroupKernel &gyro, &accel, &mag;
  std::size_t channels;  // that they need, from the first on
};

template <int kN>
[[gnu::always_inline]] inline void Solve(const GroupKernel& group, const CountsOf<kN>& counts,
                                         const float* rates, const Side<kN, float>& f,
                                         Side<kN>& u) {
  Linear<kN>(group, counts, u);
  if (group.feels_force || group.heats) TakeSmall<kN>(group, f, rates, u);
  if (group.second_order) Refine<kN>(group, u);
}

// kN samples from the `first` of a run at one temperature.
template <int kN>
void CalibrateSide(const Kernels& groups, const RawSample* raw, const HeatingRates& rates,
                   std::size_t first, ImuSample* out) {
  // The force first: the gyros feel it.
  const CountsOf<kN> counts(raw + first, groups.channels);
  Side<kN> u;
  Side<kN, float> f;
  for (Lanes<kN, float>& component : f) component.setZero();
  Solve<kN>(groups.accel, counts, rates.accel.data() + first, f, u);
  Put<kN>(u, out + first, &ImuSample::f_T);
  for (std::size_t i = 0; i < 3; ++i) f[i] = u[i].template cast<float>();
  Solve<kN>(groups.gyro, counts, rates.gyro.data() + first, f, u);
  Put<kN>(u, out + first, &ImuSample::w_IT_T);
  if (groups.mag.n_channels > 0) {
    Solve<kN>(groups.mag, counts, rates.mag.data() + first, f, u);
  } else {
    for (Lanes<kN>& component : u) component.setZero();
  }
  Put<kN>(u, out + first, &ImuSample::b_T);
}

}  // namespace

struct SampleCalibrator::State {
  explicit State(const ToolCalibration& model);

  bool Fits(const RawSample& raw) const {
    return raw.n_channels >= channels_needed && raw.n_temperatures >= thermometers_needed;
  }
  /// By bits: a reading that is no number is the same as itself.
  bool Changed(const RawSample& raw) const {
    bool same = prepared && raw.stamp.period_ns == period_ns;
    for (std::size_t i = 0; i < static_cast<std::size_t>(thermometers_needed); ++i) {
      same = same && std::bit_cast<std::uint32_t>(raw.temperature_raw[i]) ==
                         std::bit_cast<std::uint32_t>(raw_temperature[i]);
    }
    return !same;
  }
  void Prepare(const RawSample& raw);
  void PrepareGroup(const SensorGroup& group, double seconds, GroupSolution& solution);
  void Meet(const RawSample& raw, HeatingRates& rates);
  std::int64_t Since(const RawSample& raw);
  void Heat(std::int64_t ns) {
    for (GroupSolution* group : {&gyro, &accel, &mag}) group->Heat(ns);
  }
  void Note(std::size_t k, HeatingRates& rates) const {
    rates.gyro[k] = static_cast<float>(gyro.heating_rate());
    rates.accel[k] = static_cast<float>(accel.heating_rate());
    rates.mag[k] = static_cast<float>(mag.heating_rate());
  }
  void Calibrate(std::span<const RawSample> raw, const HeatingRates& rates,
                 std::span<ImuSample> out) const;
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

  bool heats = false;
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

// The time for which the last sample's temperature held, until this one.
std::int64_t SampleCalibrator::State::Since(const RawSample& raw) {
  const std::int64_t ns = std::max<std::int64_t>(raw.stamp.tool_time.ns - heated_to.ns, 0);
  heated_to.ns += ns;
  return ns;
}

// Makes ready for a sample at its temperature and time.
void SampleCalibrator::State::Meet(const RawSample& raw, HeatingRates& rates) {
  const bool anew = !prepared || raw.stamp.session != session;
  if (heats && !anew) Heat(Since(raw));
  if (Changed(raw)) Prepare(raw);
  if (anew) {
    session = raw.stamp.session;
    heated_to = raw.stamp.tool_time;
    for (GroupSolution* group : {&gyro, &accel, &mag}) group->Settle();
  }
  Note(0, rates);
}

void SampleCalibrator::State::Stamp(std::span<const RawSample> raw,
                                    std::span<ImuSample> out) const {
  const bool has_gz = gyro.n_channels() > 2, has_mag = mag.n_channels() > 0, flag = outside;
  const float shown = shown_temperature;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    SampleStamp& stamp = out[i].stamp = raw[i].stamp;
    stamp.temperature_outside = raw[i].stamp.temperature_outside || flag;
    stamp.temperature = shown;
    out[i].has_gz = has_gz;
    out[i].has_mag = has_mag;
  }
}

// At most kRun samples at one temperature.
void SampleCalibrator::State::Calibrate(std::span<const RawSample> raw, const HeatingRates& rates,
                                        std::span<ImuSample> out) const {
  Stamp(raw, out);
  const Kernels groups{gyro.kernel(), accel.kernel(), mag.kernel(),
                       static_cast<std::size_t>(channels_needed)};
  std::size_t i = 0;
  for (; i + kSide <= raw.size(); i += kSide) {
    CalibrateSide<kSide>(groups, raw.data(), rates, i, out.data());
  }
  for (; i < raw.size(); ++i) CalibrateSide<1>(groups, raw.data(), rates, i, out.data());
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
  HeatingRates rates;
  while (done < raw.size() && state.Fits(raw[done])) {
    state.Meet(raw[done], rates);
    std::size_t n = 1;
    for (; n < kRun && done + n < raw.size(); ++n) {
      const RawSample& next = raw[done + n];
      if (!state.Fits(next) || state.Changed(next)) break;
      if (!state.heats) continue;
      if (next.stamp.session != state.session) break;
      state.Heat(state.Since(next));
      state.Note(n, rates);
    }
    state.Calibrate(raw.subspan(done, n), rates, out.subspan(done, n));
    done += n;
  }
  return done;
}

std::optional<double> SampleCalibrator::Parity(const RawSample& raw) const {
  const State& state = *state_;
  if (state.tool.gyro.n_channels != 4 || !state.prepared || !state.Fits(raw)) return std::nullopt;
  ImuSample sample;
  HeatingRates rates;
  state.Note(0, rates);
  state.Calibrate({&raw, 1}, rates, {&sample, 1});
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
