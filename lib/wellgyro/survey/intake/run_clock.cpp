#include "wellgyro/survey/intake/run_clock.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace wellgyro {
namespace {

constexpr double kClockStep = 0.1;  // [s], less is the jitter of messages: 0.1 m of depth at 1 m/s
// Until a new tie knows its UTC: cells in a row that make a step of it.
constexpr Duration kTies{ClockTie::kCellsOfStep * ClockTie::kCell.ns};

// Times come from outside: nonsense must not overflow.
template <class Time>
double Apart(Time a, Time b) {
  return 1e-9 * (static_cast<double>(b.ns) - static_cast<double>(a.ns));
}

/// What number, tool clock and UTC say has passed between the begins of two samples [s].
struct Passed {
  double by_seq, by_tool, by_utc;
  Passed(const SampleStamp& a, const SampleStamp& b)
      : by_seq(1e-9 * b.period_ns * (static_cast<double>(b.seq) - static_cast<double>(a.seq))),
        by_tool(Apart(a.tool_time, b.tool_time)),
        by_utc(Apart(a.utc, b.utc)) {}
};

/// Length of a break [s]. At a jump: the median of those of the three that advance (of two, the
/// smaller); at a new session: by UTC. Clamped to [period, kLongest].
double TimePassed(const Passed& passed, double period, bool jumps) {
  constexpr double kLongest = 1e6;  // [s], 12 days: longer than tools stay down, finite for sums
  if (!jumps) return std::clamp(passed.by_utc, period, kLongest);
  std::array<double, 3> all{passed.by_seq, passed.by_tool, passed.by_utc};
  std::sort(all.begin(), all.end());
  const auto forwards = static_cast<std::size_t>(
      std::count_if(all.begin(), all.end(), [period](double t) { return t >= period / 2; }));
  if (forwards == 0) return period;
  return std::clamp(all[3 - forwards + (forwards - 1) / 2], period, kLongest);
}

/// How far UTC departs from what the sample numbers say, where these continue (`next`), else from
/// the nearer of numbers and tool clock [s]; 0 where both restart.
double Contradicted(const Passed& passed, bool next) {
  if (passed.by_seq < 0 && passed.by_tool < 0) return 0;
  const double off_seq = std::abs(passed.by_utc - passed.by_seq);
  const double off_tool = std::abs(passed.by_utc - passed.by_tool);
  return next ? off_seq : std::min(off_seq, off_tool);
}

}  // namespace

/// The UTC from which the stages take the length of a gap between sessions.
UtcTime RunClock::Break(const SampleStamp& stamp, bool jumps) {
  const Passed passed(*in_, stamp);
  const Duration apart = Duration::Seconds(TimePassed(passed, 1e-9 * in_->period_ns, jumps));
  const ToolTime begin = out_.tool_time + apart;
  ahead_.ns = static_cast<std::int64_t>(static_cast<std::uint64_t>(begin.ns) -
                                        static_cast<std::uint64_t>(stamp.tool_time.ns));
  const double off = jumps ? Contradicted(passed, stamp.seq == in_->seq + 1) : 0;
  doubt_ = jumps ? std::max(doubt_, off > kClockStep ? off : 0) : 0;
  if (jumps) restless_ = begin + kTies;
  session_ = static_cast<std::int32_t>(static_cast<std::uint32_t>(out_.session) + 1u);
  broken_ = true;
  steps_ = 0;
  return out_.utc + apart;
}

inline void RunClock::NoteSteps() {
  step_.reset();
  if (tie_.steps() == steps_) return;
  steps_ = tie_.steps();
  if (std::abs(tie_.step()) <= kClockStep) return;
  step_ = tie_.step();
  doubt_ += std::abs(*step_);
}

UtcTime RunClock::Expected(const SampleStamp& stamp) const {
  if (!in_ || stamp.session != in_->session) return stamp.utc;
  return tie_.ToUtc(ToolTime{static_cast<std::int64_t>(
      static_cast<std::uint64_t>(stamp.tool_time.ns) + static_cast<std::uint64_t>(ahead_.ns))});
}

SampleStamp RunClock::Continued(SampleStamp stamp) const {
  if (broken_) {
    stamp.session = session_;
    stamp.tool_time.ns = static_cast<std::int64_t>(static_cast<std::uint64_t>(stamp.tool_time.ns) +
                                                   static_cast<std::uint64_t>(ahead_.ns));
  }
  stamp.utc_unsynced |= doubt_ > 0;
  return stamp;
}

std::size_t RunClock::Follow(std::span<const ImuSample> samples) {
  if (!in_ || samples.empty() || (restless_ && out_.tool_time < *restless_)) return 0;
  const std::size_t n = tie_.Follow(out_.tool_time, Duration{in_->period_ns}, samples.size());
  if (n == 0) return 0;
  in_ = samples[n - 1].stamp;
  out_ = Continued(*in_);
  step_.reset();
  return n;
}

const SampleStamp& RunClock::Take(const SampleStamp& stamp, bool jumps) {
  const bool breaks = in_ && (jumps || stamp.session != in_->session);
  const UtcTime utc = breaks ? Break(stamp, jumps) : stamp.utc;
  in_ = stamp;
  out_ = Continued(stamp);
  out_.utc_unsynced = stamp.utc_unsynced;  // to the tie; what it says of this one may raise doubts
  tie_.Push(out_);
  NoteSteps();
  out_.utc = utc;
  if (doubt_ > 0 || (restless_ && out_.tool_time < *restless_)) out_.utc_unsynced = true;
  return out_;
}

}  // namespace wellgyro
