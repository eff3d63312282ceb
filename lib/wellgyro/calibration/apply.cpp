#include "wellgyro/calibration/apply.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/group_kernel_internal.h"
#include "wellgyro/calibration/group_solution_internal.h"
#include "wellgyro/calibration/sample_lanes_internal.h"

namespace wellgyro {

namespace {

/// Where SampleCalibrator's groups stand side by side.
constexpr std::size_t kGyro = 0, kAccel = 1, kMag = 2, kGroups = 3;
/// Where temperatures stand: of one thermometer a group, of the one that the stamp shows, and 0.
constexpr std::size_t kPlaces = kGroups + 2, kNoThermometer = kPlaces - 1;

/// What stands beside a run of samples, and what becomes of them.
struct Run {
  struct Group {
    OfRun<float> x{}, heating_rate{};
    Vectors u{};  ///< in T
  };
  Counts counts{};
  std::array<OfRun<double>, kPlaces> temperature{};  ///< true, of each thermometer in use [degC]
  OfRun<std::int64_t> inside{};                      ///< all bits where within what was calibrated
  OfRun<std::int64_t> inside_shown{};                ///< likewise, of a thermometer only shown
  OfRun<std::int64_t> since{};                       ///< the sample before [ns]
  OfRun<double> per_second{};                        ///< one over the period [1/s]
  std::array<Group, kGroups> groups{};
};

double PerSecond(const RawSample& raw) {
  return 1 / (static_cast<double>(std::max(raw.stamp.period_ns, 1)) * 1e-9);
}

}  // namespace

struct SampleCalibrator::State {
  explicit State(const ToolCalibration& model);

  bool Fits(const RawSample& raw) const {
    return raw.n_channels >= channels_needed && raw.n_temperatures >= thermometers_needed;
  }
  std::size_t PlaceOf(int thermometer);
  void ShareCells();
  std::size_t Take(std::span<const RawSample> raw, ImuSample* out);
  void Read(std::span<const RawSample> raw);
  void Heat(Part part);
  std::size_t EndOfCells(Part part);
  void Calibrate(Part part, Run& to) const;
  void Write(std::span<ImuSample> out) const;

  ToolCalibration tool;
  std::int32_t channels_needed = 0, thermometers_needed = 0;
  std::array<GroupSolution, kGroups> groups;
  std::vector<int> in_use;                   ///< thermometers, those of groups first
  std::size_t of_groups = 0;                 ///< of them so many
  std::array<std::size_t, kGroups> place{};  ///< of each group's temperature
  std::size_t shown = kNoThermometer;        ///< place of that in the stamp
  std::array<std::size_t, kGroups> like{};   ///< the first group whose cells are as this one's
  Lanes lanes = MostLanes();
  bool heats = false, pulses = false;

  Run run;
  std::size_t last = 0;  ///< sample of the run that Apply saw last
  bool prepared = false;
  std::int32_t session = 0;
  ToolTime heated_to;
};

SampleCalibrator::State::State(const ToolCalibration& model) : tool(model) {
  // Sizes that each measures well.
  constexpr std::array kUnits{units::kDeg, units::kStandardGravity, 5e-5};
  const std::array models{&tool.gyro, &tool.accel, &tool.mag};
  for (std::size_t i = 0; i < kGroups; ++i) {
    const SensorGroup& group = *models[i];
    place[i] = kNoThermometer;
    if (group.n_channels == 0) continue;
    groups[i] = GroupSolution(group, kUnits[i]);
    place[i] = PlaceOf(group.thermometer);
    if (place[i] == kNoThermometer) groups[i].Enter(0);
    for (int c = 0; c < group.n_channels; ++c) {
      channels_needed = std::max(channels_needed, group.channel[static_cast<std::size_t>(c)] + 1);
    }
    heats = heats || groups[i].heats();
    pulses = pulses || group.per_second;
  }
  ShareCells();
  of_groups = in_use.size();
  // The gyros' thermometer, or the first.
  if (!tool.thermometers.empty()) shown = PlaceOf(std::max(tool.gyro.thermometer, 0));
  for (const ThermometerCalibration& thermometer : tool.thermometers) {
    thermometers_needed = std::max(thermometers_needed, thermometer.channel + 1);
  }
}

// Groups of one thermometer and range have the same cells.
void SampleCalibrator::State::ShareCells() {
  for (std::size_t i = 0; i < kGroups; ++i) {
    like[i] = i;
    for (std::size_t j = i; j-- > 0;) {
      if (place[j] == place[i] && groups[j].Shares(groups[i])) like[i] = j;
    }
    groups[like[i]].Narrow(groups[i]);
  }
  for (std::size_t i = 0; i < kGroups; ++i) groups[i].Narrow(groups[like[i]]);
}

// Where a thermometer's temperatures stand.
std::size_t SampleCalibrator::State::PlaceOf(int thermometer) {
  if (thermometer < 0) return kNoThermometer;
  const auto at = std::find(in_use.begin(), in_use.end(), thermometer);
  if (at == in_use.end()) return in_use.push_back(thermometer), in_use.size() - 1;
  return static_cast<std::size_t>(at - in_use.begin());
}

// Gives how many samples, kRun at most, are of one session; none that does not fit.
std::size_t SampleCalibrator::State::Take(std::span<const RawSample> raw, ImuSample* out) {
  const std::size_t most = std::min(kRun, raw.size());
  const std::int32_t of_session = most > 0 ? raw[0].stamp.session : 0;
  const bool anew = most > 0 && (!prepared || of_session != session);
  std::int64_t last_ns = anew ? raw[0].stamp.tool_time.ns : heated_to.ns;
  std::size_t n = 0;
  for (; n < most && Fits(raw[n]) && raw[n].stamp.session == of_session; ++n) {
    // The time for which the last sample's temperature held, until this one.
    const std::int64_t ns = std::max(raw[n].stamp.tool_time.ns, last_ns);
    run.since[n] = ns - last_ns;
    last_ns = ns;
  }
  if (n == 0) return 0;
  heated_to.ns = last_ns;
  prepared = true;
  session = of_session;
  last = n - 1;
  Read(raw.first(n));
  for (std::size_t i = 0; anew && i < kGroups; ++i) groups[i].Settle(run.temperature[place[i]][0]);
  // What each sample's heating leaves to the next is a chain, beside which there is time for more.
  constexpr std::size_t kPiece = 8;
  for (std::size_t k = 0; k < n; k += kPiece) {
    const std::span<const RawSample> piece = raw.subspan(k, std::min(kPiece, n - k));
    if (heats) Heat({k, k + piece.size()});
    Transpose(lanes, piece, static_cast<std::size_t>(channels_needed), k, run.counts);
    Stamp(piece, &run.temperature[shown][k], tool.gyro.n_channels > 2, tool.mag.n_channels > 0,
          out + k);
  }
  return n;
}

// Thermometers and periods.
void SampleCalibrator::State::Read(std::span<const RawSample> raw) {
  run.inside.fill(-1);
  for (std::size_t t = 0; t < in_use.size(); ++t) {
    const ThermometerCalibration& thermometer =
        tool.thermometers[static_cast<std::size_t>(in_use[t])];
    const auto channel = static_cast<std::size_t>(thermometer.channel);
    OfRun<double>& temperature = run.temperature[t];
    for (std::size_t k = 0; k < raw.size(); ++k) {
      temperature[k] = static_cast<double>(raw[k].temperature_raw[channel]);
    }
    // The last stands beside it where lanes go on.
    std::fill_n(temperature.begin() + static_cast<std::ptrdiff_t>(raw.size()), 8,
                static_cast<double>(raw.back().temperature_raw[channel]));
    TakeTemperatures(lanes, thermometer, {0, raw.size() + 7}, temperature,
                     t < of_groups ? run.inside : run.inside_shown);
  }
  if (!pulses) return;
  for (std::size_t k = 0; k < raw.size(); ++k) run.per_second[k] = PerSecond(raw[k]);
}

void SampleCalibrator::State::Heat(Part part) {
  for (std::size_t i = 0; i < kGroups; ++i) {
    if (!groups[i].heats()) continue;
    groups[i].Heat(std::span(run.since).subspan(part.begin, part.end - part.begin),
                   &run.temperature[place[i]][part.begin], &run.groups[i].heating_rate[part.begin]);
  }
}

// Enters the cells of a part's first sample. Gives where the samples end that lie in the same.
std::size_t SampleCalibrator::State::EndOfCells(Part part) {
  for (std::size_t i = 0; i < kGroups; ++i) {
    if (place[i] == kNoThermometer) continue;
    const OfRun<double>& temperature = run.temperature[place[i]];
    groups[i].Enter(temperature[part.begin]);
    if (like[i] != i) continue;
    if (Place(lanes, groups[i].place(), temperature, part, run.groups[i].x, run.inside)) continue;
    std::size_t end = part.begin + 1;
    while (end < part.end && groups[i].Holds(temperature[end])) ++end;
    part.end = end;
  }
  return part.end;
}

// A part of a run whose samples lie in the cells at hand.
void SampleCalibrator::State::Calibrate(Part part, Run& to) const {
  // The force first: the gyros feel it.
  for (const std::size_t i : {kAccel, kGyro, kMag}) {
    if (groups[i].kernel().n_channels == 0) continue;
    Run::Group& group = to.groups[i];
    const OfRun<float>& x = to.groups[like[i]].x;
    Solve(lanes, groups[i].kernel(),
          {to.counts.data(), x, group.heating_rate, to.groups[kAccel].u, to.per_second}, part,
          group.u);
  }
}

// Of a run that was calibrated.
void SampleCalibrator::State::Write(std::span<ImuSample> out) const {
  Put(lanes, run.groups[kGyro].u, run.groups[kAccel].u, run.groups[kMag].u, out);
  std::int64_t all_inside = -1;
  for (std::size_t k = 0; k < out.size(); ++k) all_inside &= run.inside[k];
  for (std::size_t k = 0; all_inside == 0 && k < out.size(); ++k) {
    if (run.inside[k] == 0) out[k].stamp.temperature_outside = true;
  }
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
  while (done < raw.size()) {
    const std::size_t n = state.Take(raw.subspan(done), &out[done]);
    if (n == 0) break;
    for (Part part{0, n}; part.begin < n; part = {part.end, n}) {
      part.end = state.EndOfCells(part);
      state.Calibrate(part, state.run);
    }
    state.Write(out.subspan(done, n));
    done += n;
  }
  return done;
}

std::optional<double> SampleCalibrator::Parity(const RawSample& raw) const {
  const State& state = *state_;
  if (state.tool.gyro.n_channels != 4 || !state.prepared || !state.Fits(raw)) return std::nullopt;
  Run one;
  Transpose(state.lanes, {&raw, 1}, static_cast<std::size_t>(state.channels_needed), 0, one.counts);
  one.per_second[0] = PerSecond(raw);
  for (std::size_t i = 0; i < kGroups; ++i) {
    one.groups[i].x[0] = state.run.groups[i].x[state.last];
    one.groups[i].heating_rate[0] = state.run.groups[i].heating_rate[state.last];
  }
  state.Calibrate({0, 1}, one);
  const auto at = [&](std::size_t i) {
    const Vectors& u = one.groups[i].u;
    return Eigen::Vector3d(u[0][0], u[1][0], u[2][0]);
  };
  return state.groups[kGyro].Parity(raw, state.run.temperature[state.place[kGyro]][state.last],
                                    static_cast<double>(one.groups[kGyro].heating_rate[0]),
                                    at(kGyro), at(kAccel));
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
