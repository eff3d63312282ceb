#include "wellgyro/depth/clock_tie.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

namespace wellgyro {
namespace {

// Pairs are averaged over whole seconds of the tool's clock. A batch has one pair of its own, and
// its other samples repeat that pair's difference: a difference that stays is taken once, and again
// after ten seconds, since that of clocks in perfect step never changes.
constexpr std::int64_t kCellNs = ClockTie::kCell.ns;
constexpr std::int64_t kRepeatNs = 10'000'000'000;
// Sigmas beyond which a cell is refused, P = 5.7e-7: a good one in 20 days.
constexpr double kGate = 5;
constexpr double kDoubtAfter = 60;  // [s] without a synchronised cell: 6 ms at sigma_drift
// Innovations x^2 teach the variance by a gain 1 / (kTaught + cells), from 1/kTaught to 1/65, which
// tells it to sqrt(2 / 129) = 12 % (30 or 120 cells move no end by 0.001 sigma); one x counts for
// three sigmas at most, E[min(x^2, 9)] = 0.995.
constexpr double kTaught = 5, kLearn = 60, kSurpriseMost = 9;
// Least share of the variance stated: 2 ms sqrt(1e-6) = 2 us, near the steps that UTC comes in.
constexpr double kScaleMin = 1e-6;
constexpr double kQuantum = 1e-6 / 3.5;  // 1 us / sqrt(12) of rounding [s]

std::int64_t FloorCell(ToolTime time) {
  const std::int64_t cell = time.ns / kCellNs;
  return cell * kCellNs > time.ns ? cell - 1 : cell;
}

// Times come from outside: nonsense must not overflow, it is refused by its size later.
template <class Time>
std::int64_t Since(Time time, Time zero) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(time.ns) -
                                   static_cast<std::uint64_t>(zero.ns));
}

std::int64_t Sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

double Seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

// As std::llround does it, which is a call for every sample.
std::int64_t Nanoseconds(double seconds) {
  constexpr double kMost = 9e18;  // [ns], within the int64 that it becomes, 2^63 = 9.2e18
  const double ns = std::clamp(seconds * 1e9, -kMost, kMost);
  const auto whole = static_cast<std::int64_t>(ns);
  const double rest = ns - static_cast<double>(whole);
  return whole + (rest >= 0.5) - (rest <= -0.5);
}

}  // namespace

ClockTie::ClockTie(const ClockTieSetup& setup) : setup_(setup) {
  if (!(setup.sigma_pair > 0)) throw std::invalid_argument("ClockTie: sigma_pair must be positive");
  if (!(setup.sigma_drift > 0)) {
    throw std::invalid_argument("ClockTie: sigma_drift must be positive");
  }
  if (!(setup.walk_drift >= 0)) {
    throw std::invalid_argument("ClockTie: walk_drift must not be negative");
  }
  if (!(setup.unsynced_factor >= 1)) {
    throw std::invalid_argument("ClockTie: unsynced_factor must be at least 1");
  }
}

void ClockTie::Restart(const SampleStamp& stamp) {
  *this = ClockTie(setup_);
  known_ = true;
  session_ = stamp.session;
  tool0_ = stamp.tool_time;
  utc0_ = stamp.utc;
  last_ns_ = -1;
  p00_ = CellVariance(!stamp.utc_unsynced);
  p11_ = setup_.sigma_drift * setup_.sigma_drift;
  if (!stamp.utc_unsynced) synced_ns_ = 0;
}

void ClockTie::Push(const SampleStamp& stamp) {
  if (!known_ || stamp.session != session_) Restart(stamp);
  const std::int64_t tool_ns = Since(stamp.tool_time, tool0_);
  if (tool_ns <= last_ns_) return;
  last_ns_ = tool_ns;
  const std::int64_t difference = Since(UtcTime{Since(stamp.utc, utc0_)}, UtcTime{tool_ns});
  // Within a batch the difference stays the same to the nanosecond: only where it changes does the
  // surface say something new. Clocks in perfect step never change it; they may speak too, rarely.
  const bool fresh = difference != difference_ || tool_ns == 0 || tool_ns - fresh_ns_ >= kRepeatNs;
  difference_ = difference;
  const std::int64_t into = Since(stamp.tool_time, ToolTime{cell_.index * kCellNs});
  if (into < 0 || into >= kCellNs) {
    CloseCell();
    cell_.index = FloorCell(stamp.tool_time);
  }
  if (!fresh) return;
  fresh_ns_ = tool_ns;
  AddPair(tool_ns, difference, !stamp.utc_unsynced);
}

std::size_t ClockTie::Follow(ToolTime last, Duration period, std::size_t count) {
  if (!known_ || period.ns <= 0 || Since(last, tool0_) != last_ns_) return 0;
  const std::int64_t into = Since(last, ToolTime{cell_.index * kCellNs});
  if (into < 0 || into >= kCellNs) return 0;
  const std::int64_t left =
      std::min(kCellNs - into, kRepeatNs - Since(ToolTime{last_ns_}, ToolTime{fresh_ns_}));
  const std::int64_t most = left > 0 ? (left - 1) / period.ns : 0;
  const std::int64_t taken = std::min(most, static_cast<std::int64_t>(count));
  last_ns_ += taken * period.ns;
  return static_cast<std::size_t>(taken);
}

void ClockTie::AddPair(std::int64_t tool_ns, std::int64_t difference, bool synced) {
  if (synced && cell_.synced == 0) cell_.pairs = 0;  // these alone count
  if (!synced && cell_.synced > 0) return;
  if (cell_.pairs == 0) {
    cell_ = {.index = cell_.index, .tool_ns = tool_ns, .difference = difference};
  }
  ++cell_.pairs;
  if (synced) ++cell_.synced;
  cell_.sum_tool += Seconds(tool_ns - cell_.tool_ns);
  cell_.sum_difference += Seconds(Since(UtcTime{difference}, UtcTime{cell_.difference}));
}

double ClockTie::CellVariance(bool synced) const {
  const double unsynced = setup_.sigma_pair * setup_.unsynced_factor;
  const double jitter = scale_ * setup_.sigma_pair * setup_.sigma_pair;
  return jitter + (synced ? 0 : unsynced * unsynced) + kQuantum * kQuantum;
}

void ClockTie::CloseCell() {
  if (cell_.pairs == 0) return;
  const bool synced = cell_.synced > 0;
  const double n = static_cast<double>(cell_.pairs);
  const double offset = Seconds(cell_.difference) + cell_.sum_difference / n;
  const std::int64_t at = cell_.tool_ns + Nanoseconds(cell_.sum_tool / n);
  cell_.pairs = 0;
  cell_.synced = 0;

  const double variance = CellVariance(synced);
  if (cells_ == 0) {
    mid_ns_ = at;
    offset_ = offset;
    p00_ = variance;
    cells_ = 1;
    return;
  }
  Predict(at);
  const double innovation = offset - offset_;
  const double surprise = innovation * innovation / (p00_ + variance);
  if (surprise < kGate * kGate) {
    Update(innovation, variance);
    if (synced) {
      Learn(surprise);
      synced_ns_ = at;
    }
  } else {
    Refuse(innovation, variance, synced);
  }
}

void ClockTie::Predict(std::int64_t tool_ns) {
  const double dt = Seconds(tool_ns - mid_ns_);
  const double q = setup_.walk_drift * setup_.walk_drift;
  mid_ns_ = tool_ns;
  offset_ += drift_ * dt;
  p00_ += dt * (2 * p01_ + dt * (p11_ + q * dt / 3));
  p01_ += dt * (p11_ + q * dt / 2);
  p11_ += q * dt;
}

void ClockTie::Update(double innovation, double variance) {
  const double s = p00_ + variance;
  const double k0 = p00_ / s, k1 = p01_ / s;
  offset_ += k0 * innovation;
  drift_ += k1 * innovation;
  p11_ -= k1 * p01_;
  p01_ *= variance / s;
  p00_ *= variance / s;
  ++cells_;
  refused_ = 0;
  refused_sum_ = 0;
}

// The innovations teach the jitter; single large ones teach no more.
void ClockTie::Learn(double surprise) {
  const double gain = 1 / (kTaught + std::min(static_cast<double>(cells_), kLearn));
  Rescale(std::max(1 + gain * (std::min(surprise, kSurpriseMost) - 1), kScaleMin / scale_));
}

// What was concluded under a jitter thought too small is as much too sure as the jitter was.
void ClockTie::Rescale(double factor) {
  scale_ *= factor;
  p00_ *= factor;
  p01_ *= factor;
  p11_ *= factor;
}

void ClockTie::Refuse(double innovation, double variance, bool synced) {
  const double mean = refused_ > 0 ? refused_sum_ / refused_ : innovation;
  const double off = innovation - mean;
  if (off * off > kGate * kGate * (p00_ + 2 * variance)) {
    // Neither the tie nor each other: the jitter has grown.
    if (synced) Rescale(2);
    refused_ = 0;
    refused_sum_ = 0;
  }
  ++refused_;
  refused_sum_ += innovation;
  if (refused_ < kCellsOfStep) return;
  const std::int64_t step = Nanoseconds(refused_sum_ / refused_);
  utc0_.ns = Sum(utc0_.ns, step);
  p00_ = variance;
  p01_ = 0;
  ++steps_;
  step_ = Seconds(step);
  refused_ = 0;
  refused_sum_ = 0;
}

UtcTime ClockTie::ToUtc(ToolTime time) const {
  assert(known_);
  const std::int64_t tool_ns = Since(time, tool0_);
  const double since_mid = Seconds(tool_ns - mid_ns_);
  const std::int64_t offset_ns = Nanoseconds(offset_ + drift_ * since_mid);
  return {Sum(Sum(utc0_.ns, tool_ns), offset_ns)};
}

void ClockTie::ToUtc(ToolTime first, Duration period, std::span<UtcTime> utc) const {
  assert(known_);
  std::int64_t tool_ns = Since(first, tool0_);
  for (UtcTime& time : utc) {
    const std::int64_t offset_ns = Nanoseconds(offset_ + drift_ * Seconds(tool_ns - mid_ns_));
    time = {Sum(Sum(utc0_.ns, tool_ns), offset_ns)};
    tool_ns = Sum(tool_ns, period.ns);
  }
}

double ClockTie::Sigma(ToolTime time) const {
  assert(known_);
  const double dt = Seconds(Since(time, tool0_) - mid_ns_);
  const double q = setup_.walk_drift * setup_.walk_drift;
  const double walk = q * std::abs(dt) * dt * dt / 3;
  return std::sqrt(std::max(0.0, p00_ + dt * (2 * p01_ + dt * p11_) + walk));
}

double ClockTie::sigma_drift() const { return std::sqrt(std::max(0.0, p11_)); }

bool ClockTie::doubtful() const {
  if (!synced_ns_ || refused_ > 1) return true;
  return Seconds(last_ns_ - *synced_ns_) > kDoubtAfter;
}

}  // namespace wellgyro
