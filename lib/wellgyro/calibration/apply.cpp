#include "wellgyro/calibration/apply.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/group_kernel_internal.h"
#include "wellgyro/calibration/group_solution_internal.h"
#include "wellgyro/calibration/sample_lanes_internal.h"
#include "wellgyro/record/sample_block.h"

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
  OfRun<double> per_second{};                        ///< one over the period [1/s]
  std::array<Group, kGroups> groups{};
};

/// Brings the next piece into the nearest memory while this one is taken.
void FetchNext(std::span<const RawSample> raw) {
  if (raw.size() < 2 * kPiece) return;
  const auto* begin = reinterpret_cast<const std::byte*>(&raw[kPiece]);
#pragma GCC unroll 64
  for (std::size_t at = 0; at < kPiece * sizeof(RawSample); at += kCacheLine) {
    __builtin_prefetch(begin + at);
  }
}

constexpr std::size_t kSession = offsetof(RawSample, stamp) + offsetof(SampleStamp, session);
static_assert(offsetof(RawSample, n_temperatures) ==
              offsetof(RawSample, n_channels) + sizeof(std::int32_t));

/// Two numbers that stand beside each other: channels and thermometers, or session and run.
template <std::size_t kAt>
std::uint64_t PairAt(const RawSample& raw) {
  std::uint64_t pair;
  std::memcpy(&pair, reinterpret_cast<const std::byte*>(&raw) + kAt, sizeof pair);
  return pair;
}

/// Of less than a whole piece: the last reading stands in for what lacks.
[[gnu::noinline]] Apart Pad(std::span<const RawSample> piece, std::size_t channel,
                            std::array<float, kPiece>& readings) {
  for (std::size_t k = 0; k < kPiece; ++k) {
    readings[k] = piece[std::min(k, piece.size() - 1)].temperature_raw[channel];
  }
  return {reinterpret_cast<const std::byte*>(readings.data()), sizeof(float)};
}

double PerSecond(const RawSample& raw) {
  return 1 / (static_cast<double>(std::max(raw.stamp.period_ns, 1)) * 1e-9);
}

[[gnu::noinline]] void ReadPeriods(std::span<const RawSample> piece, double* per_second) {
  for (const RawSample& raw : piece) *per_second++ = PerSecond(raw);
}

}  // namespace

struct SampleCalibrator::State {
  explicit State(const ToolCalibration& model);

  bool Fits(const RawSample& raw) const {
    return raw.n_channels >= channels_needed && raw.n_channels <= RawSample::kChannelsMax &&
           raw.n_temperatures >= thermometers_needed &&
           raw.n_temperatures <= RawSample::kTemperaturesMax;
  }
  std::size_t PlaceOf(int thermometer);
  void ShareCells();
  std::size_t Take(std::span<const RawSample> raw, ImuSample* out);
  void Begin(const RawSample& raw);
  bool FollowsEvenly(std::span<const RawSample> piece, HeatSteps& steps);
  std::size_t Follow(std::span<const RawSample> piece, HeatSteps& steps);
  std::size_t TakePiece(std::span<const RawSample> piece, std::size_t at, ImuSample* out);
  void Read(std::span<const RawSample> piece, std::size_t at);
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
  // [rad/s, m/s^2, T], sizes that each measures well, to which roundings are held: 240 times the
  // Earth's rate, gravity, the Earth's field.
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
  if (most == 0 || !Fits(raw[0])) return 0;
  if (!prepared || raw[0].stamp.session != session) Begin(raw[0]);
  std::size_t n = 0;
  while (n < most) {
    FetchNext(raw.subspan(n));
    const std::span<const RawSample> piece = raw.subspan(n, std::min(kPiece, most - n));
    const std::size_t taken = TakePiece(piece, n, out + n);
    n += taken;
    if (taken < piece.size()) break;
  }
  last = n - 1;
  // The last stands beside it where lanes go on.
  for (std::size_t t = 0; t < in_use.size(); ++t) {
    std::fill_n(&run.temperature[t][n], kBeyond, run.temperature[t][last]);
  }
  return n;
}

// A session.
void SampleCalibrator::State::Begin(const RawSample& raw) {
  session = raw.stamp.session;
  heated_to = raw.stamp.tool_time;
  prepared = true;
  Read({&raw, 1}, 0);
  for (std::size_t i = 0; i < kGroups; ++i) groups[i].Settle(run.temperature[place[i]][0]);
}

// Gives how many samples of a piece belong to the session, until one that does not fit. What each
// sample's heating leaves to the next is a chain, beside which there is time for more.
std::size_t SampleCalibrator::State::TakePiece(std::span<const RawSample> piece, std::size_t at,
                                               ImuSample* out) {
  HeatSteps steps;
  const std::size_t n = FollowsEvenly(piece, steps) ? piece.size() : Follow(piece, steps);
  if (n == 0) return 0;
  piece = piece.first(n);
  Read(piece, at);
  for (std::size_t i = 0; heats && i < kGroups; ++i) {
    if (!groups[i].heats()) continue;
    groups[i].Heat(steps, n, &run.temperature[place[i]][at], &run.groups[i].heating_rate[at]);
  }
  Transpose(lanes, piece, static_cast<std::size_t>(channels_needed), at, run.counts);
  Stamp(lanes, piece, &run.temperature[shown][at], tool.gyro.n_channels > 2,
        tool.mag.n_channels > 0, out);
  return n;
}

// Whether a whole piece belongs to the session and its samples are alike and follow each other
// evenly, which is found without a branch for each.
bool SampleCalibrator::State::FollowsEvenly(std::span<const RawSample> piece, HeatSteps& steps) {
  const RawSample& first = piece[0];
  if (piece.size() != kPiece || !Fits(first) || first.stamp.session != session) return false;
  auto before = static_cast<std::uint64_t>(heated_to.ns);
  const std::uint64_t step = static_cast<std::uint64_t>(first.stamp.tool_time.ns) - before;
  const std::uint64_t channels = PairAt<offsetof(RawSample, n_channels)>(first);
  const std::uint64_t session_and_run = PairAt<kSession>(first);
  std::uint64_t odd = step >> 63;
#pragma GCC unroll 16
  for (const RawSample& raw : piece.first<kPiece>()) {
    const auto now = static_cast<std::uint64_t>(raw.stamp.tool_time.ns);
    odd |= (now - before) ^ step;
    odd |= PairAt<offsetof(RawSample, n_channels)>(raw) ^ channels;
    odd |= PairAt<kSession>(raw) ^ session_and_run;
    before = now;
  }
  if (odd != 0) return false;
  heated_to = piece[kPiece - 1].stamp.tool_time;
  steps.even = true;
  steps.since[0] = static_cast<std::int64_t>(step);
  return true;
}

std::size_t SampleCalibrator::State::Follow(std::span<const RawSample> piece, HeatSteps& steps) {
  std::size_t n = 0;
  for (; n < piece.size() && Fits(piece[n]) && piece[n].stamp.session == session; ++n) {
    const std::int64_t ns = std::max(piece[n].stamp.tool_time.ns, heated_to.ns);
    steps.since[n] = ns - heated_to.ns;
    heated_to.ns = ns;
  }
  return n;
}

// Thermometers and periods of a piece.
void SampleCalibrator::State::Read(std::span<const RawSample> piece, std::size_t at) {
  std::fill_n(&run.inside[at], kPiece, -1);
  for (std::size_t t = 0; t < in_use.size(); ++t) {
    const ThermometerCalibration& thermometer =
        tool.thermometers[static_cast<std::size_t>(in_use[t])];
    const auto channel = static_cast<std::size_t>(thermometer.channel);
    std::array<float, kPiece> padded;
    const Apart readings =
        piece.size() == kPiece
            ? Apart{reinterpret_cast<const std::byte*>(&piece[0].temperature_raw[channel]),
                    sizeof(RawSample)}
            : Pad(piece, channel, padded);
    TakeTemperatures(lanes, thermometer, readings, at, run.temperature[t],
                     t < of_groups ? run.inside : run.inside_shown);
  }
  if (pulses) ReadPeriods(piece, &run.per_second[at]);
}

// Enters the cells of a part's first sample. Gives where the samples end that lie in the same.
std::size_t SampleCalibrator::State::EndOfCells(Part part) {
  std::array<bool, kGroups> entered{};
  for (std::size_t i = 0; i < kGroups; ++i) {
    if (place[i] == kNoThermometer) continue;
    const OfRun<double>& temperature = run.temperature[place[i]];
    // Groups of the same cells go through them together.
    if (like[i] != i) {
      if (entered[like[i]]) groups[i].Enter(temperature[part.begin]);
      continue;
    }
    entered[i] = groups[i].Enter(temperature[part.begin]);
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
#pragma GCC unroll 8
  for (std::size_t k = 0; k < kRun; ++k) all_inside &= run.inside[k];
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
  if (raw.n_channels > RawSample::kChannelsMax ||
      raw.n_temperatures > RawSample::kTemperaturesMax) {
    return fmt::format("sample {} has {} channels and {} thermometers, of which {} and {} fit",
                       raw.stamp.seq, raw.n_channels, raw.n_temperatures, RawSample::kChannelsMax,
                       RawSample::kTemperaturesMax);
  }
  return fmt::format("sample {} has {} thermometers where the tool model needs {}", raw.stamp.seq,
                     raw.n_temperatures, state.thermometers_needed);
}

}  // namespace wellgyro
