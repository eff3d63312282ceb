#include "wellgyro/calibration/apply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/group_solution_internal.h"
#include "wellgyro/calibration/thermometer.h"

namespace wellgyro {

namespace {

/// Samples that are looked at together.
constexpr std::size_t kRun = 32;

/// What stands beside the counts of a run of samples: a number a sample.
struct Run {
  struct Group {
    std::array<float, kRun> x{}, heating_rate{};
  };
  Group gyro, accel, mag;
  std::array<float, kRun> temperature{};
  std::array<bool, kRun> outside{};
};

struct Kernels {
  const GroupKernel &gyro, &accel, &mag;
  std::size_t channels;  // that they need, from the first on
};

template <int kN>
using SolveOf = void (*)(const GroupKernel&, const CountsOf<kN>&, const Beside<kN>&, Side<kN>&);

template <int kN, unsigned kWhat>
void Solve(const GroupKernel& group, const CountsOf<kN>& counts, const Beside<kN>& beside,
           Side<kN>& into) {
  constexpr bool kFour = (kWhat & 1) != 0, kVaries = (kWhat & 2) != 0, kMoved = (kWhat & 4) != 0;
  Side<kN> u;
  SingleSide<kN> slope;
  Linear<kN, kFour, kVaries>(group, counts, u, slope);
  if constexpr (kVaries || kMoved) TakeSmall<kN, kVaries, kMoved>(group, beside, slope, u);
  if constexpr ((kWhat & 8) != 0) Refine<kN>(group, u);
  into = u;
}

template <int kN, unsigned... kWhat>
constexpr std::array<SolveOf<kN>, sizeof...(kWhat)> SolversOf(
    std::integer_sequence<unsigned, kWhat...>) {
  return {Solve<kN, kWhat>...};
}

/// The one for what a group has.
template <int kN>
SolveOf<kN> SolverOf(const GroupKernel& g) {
  static constexpr auto kSolvers = SolversOf<kN>(std::make_integer_sequence<unsigned, 16>());
  return kSolvers[(g.n_channels == 4 ? 1U : 0U) + (g.varies ? 2U : 0U) + (g.moved ? 4U : 0U) +
                  (g.second_order ? 8U : 0U)];
}

// Samples of a run, kN at a time, from the `first` on while there are so many. Gives where it ends.
template <int kN>
std::size_t CalibrateSides(const Kernels& groups, std::span<const RawSample> raw, const Run& run,
                           std::size_t first, ImuSample* out) {
  const auto gyro = SolverOf<kN>(groups.gyro), accel = SolverOf<kN>(groups.accel),
             mag = SolverOf<kN>(groups.mag);
  const bool has_mag = groups.mag.n_channels > 0;
  std::size_t i = first;
  for (; i + kN <= raw.size(); i += kN) {
    const CountsOf<kN> counts(raw.data() + i, groups.channels);
    const auto beside = [&](const Run::Group& group, const SingleSide<kN>& f) {
      return Beside<kN>{Load<kN>(group.x.data() + i), Load<kN>(group.heating_rate.data() + i), f};
    };
    // The force first: the gyros feel it.
    Side<kN> u;
    accel(groups.accel, counts, beside(run.accel, {}), u);
    Put<kN>(u, out + i, &ImuSample::f_T);
    gyro(groups.gyro, counts, beside(run.gyro, {ToSingle(u[0]), ToSingle(u[1]), ToSingle(u[2])}),
         u);
    Put<kN>(u, out + i, &ImuSample::w_IT_T);
    u = {};
    if (has_mag) mag(groups.mag, counts, beside(run.mag, {}), u);
    Put<kN>(u, out + i, &ImuSample::b_T);
  }
  return i;
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
  /// Groups and their solutions.
  template <class Do>
  void ForEach(Do&& visit) {
    visit(tool.gyro, gyro);
    visit(tool.accel, accel);
    visit(tool.mag, mag);
  }
  double TemperatureOf(const SensorGroup& group) const {
    return group.thermometer < 0 ? 0
                                 : temperature[static_cast<std::size_t>(group.thermometer)].value;
  }
  bool Read(const RawSample& raw);
  void Enter();
  void Take(const RawSample& raw);
  void Begin(const RawSample& raw);
  std::size_t Gather(std::span<const RawSample> raw, Run& run);
  std::int64_t Since(const RawSample& raw);
  void Heat(std::int64_t ns);
  void Note(std::size_t k, Run& run) const;
  void Calibrate(std::span<const RawSample> raw, const Run& run, std::span<ImuSample> out) const;
  void Stamp(std::span<const RawSample> raw, const Run& run, std::span<ImuSample> out) const;

  ToolCalibration tool;
  std::int32_t channels_needed = 0, thermometers_needed = 0;
  GroupSolution gyro, accel, mag;

  bool prepared = false;
  std::array<float, RawSample::kTemperaturesMax> raw_temperature{};
  std::int32_t period_ns = 0;
  double seconds = 0;                    ///< of the sample that was read last
  std::vector<Temperature> temperature;  ///< true, of each thermometer, of that sample
  bool outside = false;
  float shown_temperature = 0;  ///< of the gyros' thermometer, or the first [degC]

  bool heats = false;
  std::int32_t session = 0;
  ToolTime heated_to;
};

SampleCalibrator::State::State(const ToolCalibration& model)
    : tool(model), temperature(model.thermometers.size()) {
  // Sizes that each measures well.
  constexpr double kRate = units::kDeg, kForce = units::kStandardGravity, kField = 5e-5;
  if (tool.gyro.n_channels > 0) gyro = GroupSolution(tool.gyro, kRate);
  if (tool.accel.n_channels > 0) accel = GroupSolution(tool.accel, kForce);
  if (tool.mag.n_channels > 0) mag = GroupSolution(tool.mag, kField);
  ForEach([&](const SensorGroup& group, const GroupSolution& solution) {
    for (int c = 0; c < group.n_channels; ++c) {
      channels_needed = std::max(channels_needed, group.channel[static_cast<std::size_t>(c)] + 1);
    }
    heats = heats || solution.heats();
  });
  for (const ThermometerCalibration& thermometer : tool.thermometers) {
    thermometers_needed = std::max(thermometers_needed, thermometer.channel + 1);
  }
}

// Reads the thermometers. Gives whether the cells at hand hold the sample.
bool SampleCalibrator::State::Read(const RawSample& raw) {
  for (std::size_t i = 0; i < temperature.size(); ++i) {
    const ThermometerCalibration& thermometer = tool.thermometers[i];
    const auto channel = static_cast<std::size_t>(thermometer.channel);
    temperature[i] =
        TrueTemperature(thermometer, static_cast<double>(raw.temperature_raw[channel]));
  }
  seconds = static_cast<double>(std::max(raw.stamp.period_ns, 1)) * 1e-9;
  bool holds = true;
  ForEach([&](const SensorGroup& group, const GroupSolution& solution) {
    holds = holds && solution.Holds(TemperatureOf(group), seconds);
  });
  return holds;
}

void SampleCalibrator::State::Enter() {
  ForEach([&](const SensorGroup& group, GroupSolution& solution) {
    solution.Enter(TemperatureOf(group), seconds);
  });
}

// What was read holds from this sample on.
void SampleCalibrator::State::Take(const RawSample& raw) {
  raw_temperature = raw.temperature_raw;
  period_ns = raw.stamp.period_ns;
  outside = false;
  ForEach([&](const SensorGroup& group, GroupSolution& solution) {
    const double value = TemperatureOf(group);
    solution.Take(value);
    if (group.n_channels == 0 || group.thermometer < 0) return;
    const bool known = temperature[static_cast<std::size_t>(group.thermometer)].inside;
    outside = outside || !known || value < group.min || value > group.max;
  });
  const auto shown = static_cast<std::size_t>(std::max(tool.gyro.thermometer, 0));
  shown_temperature = temperature.empty() ? 0 : static_cast<float>(temperature[shown].value);
}

// The first sample of all, or of a session.
void SampleCalibrator::State::Begin(const RawSample& raw) {
  prepared = true;
  session = raw.stamp.session;
  heated_to = raw.stamp.tool_time;
  for (GroupSolution* group : {&gyro, &accel, &mag}) group->Settle();
}

// The time for which the last sample's temperature held, until this one.
std::int64_t SampleCalibrator::State::Since(const RawSample& raw) {
  const std::int64_t ns = std::max<std::int64_t>(raw.stamp.tool_time.ns - heated_to.ns, 0);
  heated_to.ns += ns;
  return ns;
}

void SampleCalibrator::State::Heat(std::int64_t ns) {
  if (gyro.heats()) gyro.Heat(ns);
  if (accel.heats()) accel.Heat(ns);
  if (mag.heats()) mag.Heat(ns);
}

void SampleCalibrator::State::Note(std::size_t k, Run& run) const {
  run.gyro.x[k] = gyro.x();
  run.accel.x[k] = accel.x();
  run.mag.x[k] = mag.x();
  run.temperature[k] = shown_temperature;
  run.outside[k] = outside;
  if (gyro.heats()) run.gyro.heating_rate[k] = static_cast<float>(gyro.heating_rate());
  if (accel.heats()) run.accel.heating_rate[k] = static_cast<float>(accel.heating_rate());
  if (mag.heats()) run.mag.heating_rate[k] = static_cast<float>(mag.heating_rate());
}

// Gives how many samples, kRun at most, lie in the same cells as the first; none that does not fit.
std::size_t SampleCalibrator::State::Gather(std::span<const RawSample> raw, Run& run) {
  std::size_t n = 0;
  for (; n < std::min(kRun, raw.size()) && Fits(raw[n]); ++n) {
    const RawSample& sample = raw[n];
    const bool changed = Changed(sample);
    if (changed && !Read(sample)) {
      if (n > 0) break;
      Enter();
    }
    const bool anew = !prepared || sample.stamp.session != session;
    if (heats && !anew) Heat(Since(sample));
    if (changed) Take(sample);
    if (anew) Begin(sample);
    Note(n, run);
  }
  return n;
}

void SampleCalibrator::State::Stamp(std::span<const RawSample> raw, const Run& run,
                                    std::span<ImuSample> out) const {
  const bool has_gz = gyro.kernel().n_channels > 2, has_mag = mag.kernel().n_channels > 0;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    SampleStamp& stamp = out[i].stamp = raw[i].stamp;
    stamp.temperature_outside = raw[i].stamp.temperature_outside || run.outside[i];
    stamp.temperature = run.temperature[i];
    out[i].has_gz = has_gz;
    out[i].has_mag = has_mag;
  }
}

// Of a run that was gathered.
void SampleCalibrator::State::Calibrate(std::span<const RawSample> raw, const Run& run,
                                        std::span<ImuSample> out) const {
  Stamp(raw, run, out);
  const Kernels groups{gyro.kernel(), accel.kernel(), mag.kernel(),
                       static_cast<std::size_t>(channels_needed)};
  const std::size_t sides = CalibrateSides<kSide>(groups, raw, run, 0, out.data());
  CalibrateSides<1>(groups, raw, run, sides, out.data());
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
  Run run;
  std::size_t done = 0;
  while (done < raw.size()) {
    const std::size_t n = state.Gather(raw.subspan(done), run);
    if (n == 0) break;
    state.Calibrate(raw.subspan(done, n), run, out.subspan(done, n));
    done += n;
  }
  return done;
}

std::optional<double> SampleCalibrator::Parity(const RawSample& raw) const {
  const State& state = *state_;
  if (state.tool.gyro.n_channels != 4 || !state.prepared || !state.Fits(raw)) return std::nullopt;
  ImuSample sample;
  Run run;
  state.Note(0, run);
  state.Calibrate({&raw, 1}, run, {&sample, 1});
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
