#include "wellgyro/survey/intake/sample_intake.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace wellgyro {
namespace {

/// At the least a sample waits for the depth marks after it that decide its depth, each as late as
/// it may be.
Duration Hold(const DepthTrack& track) {
  return track.latency() + track.ahead() + DepthGrid::kStep;
}

}  // namespace

SampleIntake::SampleIntake(const Job& job, const DepthTrack& track, CableMarks& marks, Sink& sink)
    : sink_(sink),
      latency_(track.latency()),
      queue_(Hold(track)),
      filter_(job.noise, job.errors),
      depth_(job, track, marks) {}

std::span<const ImuSample> SampleIntake::Take(std::span<const ImuSample> batch) {
  if (const std::size_t taken = queue_.Append(batch); taken > 0) return batch.subspan(taken);
  // What is ready goes on before another is sorted in, which must not depend on the batches.
  const ImuSample& sample = batch.front();
  const SampleQueue::Verdict verdict = queue_.Push(sample);
  if (verdict != SampleQueue::Verdict::kTaken) Tell(verdict, sample.stamp);
  TellStrays();
  return batch.subspan(1);
}

void SampleIntake::Flush() {
  queue_.Flush();
  flushed_ = true;
  TellStrays();
}

const AdmittedBlock* SampleIntake::Next(std::optional<UtcTime> until) {
  queue_.Release(std::exchange(admitted_count_, 0));
  while (done_.axes.empty()) {
    if (!Refill(until)) return nullptr;
  }
  Admit();
  return &admitted_;
}

/// More samples through the filter, which may keep them for now; false: none is ready.
bool SampleIntake::Refill(std::optional<UtcTime> until) {
  std::span<const ImuSample> ready = queue_.Ready();
  if (ready.empty()) {
    if (flushed_) done_ = filter_.Flush();
    return !done_.axes.empty();
  }
  ready = ready.first(CountFinal(ready));
  if (ready.empty()) return false;
  if (until) {
    const auto late = std::ranges::find_if(
        ready, [&until](const ImuSample& sample) { return sample.stamp.utc >= *until; });
    if (late == ready.begin()) {
      done_ = filter_.Flush();
      if (!done_.axes.empty()) return true;
      queue_.Pop();
      queue_.Release(1);
      return true;
    }
    ready = ready.first(static_cast<std::size_t>(late - ready.begin()));
  }
  const bool jumps = queue_.Jumps();
  if (jumps || !filter_.Continues(ready.front().stamp)) {
    // What the filter still holds ends a stretch without gaps.
    done_ = filter_.Flush();
    if (!done_.axes.empty()) return true;
    jumps_ = jumps;
  }
  done_ = filter_.Push(ready);
  queue_.Pop(done_.taken);
  return true;
}

/// How many of them have a depth that no mark will change: one of the time m has come by a sample
/// of m + latency.
std::size_t SampleIntake::CountFinal(std::span<const ImuSample> samples) {
  if (queue_.hurries()) return samples.size();
  const auto is_final = [this](const SampleStamp& stamp) {
    const UtcTime utc = clock_.Expected(stamp);
    const UtcTime until = utc + queue_.Age(stamp) - latency_;
    return depth_.Knows(utc, Duration{stamp.period_ns}, until);
  };
  if (!is_final(samples.front().stamp)) return 0;
  // Between two that are final and no further apart than a step of the grid all are.
  const ToolTime first = samples.front().stamp.tool_time;
  std::size_t count = samples.size();
  for (; count > 1; count /= 2) {
    const SampleStamp& last = samples[count - 1].stamp;
    if (last.tool_time - first < DepthGrid::kStep && is_final(last)) break;
  }
  return count;
}

/// The samples that are done, from the begin on, that make a block.
std::span<ImuSample> SampleIntake::EvenSamples() {
  const std::span<ImuSample> held = queue_.Held();
  const std::size_t most = std::min({held.size(), done_.axes.size(), SampleBlock::kMost});
  std::size_t count = 1;
  if (!done_.mended.front().any()) {
    while (count < most && !done_.mended[count].any() && IsEven(held[count - 1], held[count])) {
      ++count;
    }
  }
  return held.first(count);
}

void SampleIntake::Admit() {
  AdmittedBlock& out = admitted_;
  out.jumps = std::exchange(jumps_, false);
  out.mended = done_.mended.front();
  std::span<ImuSample> samples = EvenSamples();
  if (out.mended.any()) {
    samples.front().w_IT_T = done_.axes.front().head<3>();
    samples.front().f_T = done_.axes.front().tail<3>();
  }
  const SampleStamp first = clock_.Take(samples.front().stamp, out.jumps);
  out.step = clock_.step();
  const std::size_t count = 1 + clock_.Follow(samples.subspan(1));
  out.sent = samples.first(count);
  out.samples = {out.sent, done_.axes.first(count)};
  if (!clock_.own()) {
    std::ranges::copy(out.sent, continued_.begin());
    continued_.front().stamp = first;
    for (std::size_t i = 1; i < count; ++i) {
      continued_[i].stamp = clock_.Continued(continued_[i].stamp);
    }
    out.samples.samples = std::span(continued_).first(count);
  }
  const Duration period{first.period_ns};
  const std::span<UtcTime> utc = std::span(out.utc).first(count);
  clock_.ToUtc(first.tool_time, period, utc);
  depth_.At(utc, DepthGrid::Asks::kAll, clock_.doubt(), out.begin);
  std::array<UtcTime, SampleBlock::kMost> middle;
  for (std::size_t i = 0; i < count; ++i) middle[i] = utc[i] + Duration{period.ns / 2};
  depth_.At(std::span(middle).first(count), DepthGrid::Asks::kSpeed, clock_.doubt(), out.middle);
  done_ = {done_.axes.subspan(count), done_.mended.subspan(count), 0};
  admitted_count_ = count;
}

void SampleIntake::Count(const AdmittedBlock& block, std::size_t at, std::size_t end,
                         RunSummary& summary) {
  const SampleStamp& stamp = block.sent[at].stamp;
  if (block.mended.any()) {
    summary.samples_gyro_mended += block.mended.gyro;
    summary.samples_accel_mended += block.mended.accel;
    // One fault for all that lie near each other: six lines a minute at most.
    constexpr std::int64_t kNear = 10'000'000'000;  // [ns]
    const bool joins = mended_.count > 0 && mended_.session == stamp.session &&
                       (stamp.seq - mended_.last) * stamp.period_ns < kNear;
    if (!joins) {
      TellMended();
      mended_ = {stamp.session, stamp.seq, stamp.seq, 0};
    }
    mended_.last = stamp.seq;
    ++mended_.count;
  }
  const bool jumps = block.jumps && at == 0;
  const bool steps = block.step && at == 0;
  if (last_ && !jumps && stamp.session == last_->session && stamp.seq > last_->seq + 1) {
    const std::int64_t lost = stamp.seq - last_->seq - 1;
    summary.samples_lost += lost;
    lost_ += lost;
    ++gaps_;
    sink_.OnFault(
        Fault{FaultCode::kLost, fmt::format("samples {} to {} of session {} are missing",
                                            last_->seq + 1, stamp.seq - 1, stamp.session)});
  }
  if (jumps || steps) TellClock(block, stamp);
  summary.clock_jumps += (jumps ? 1 : 0) + (steps ? 1 : 0);
  last_ = block.sent[end - 1].stamp;
}

/// A clock that jumps within a session, or a UTC that steps against it.
void SampleIntake::TellClock(const AdmittedBlock& block, const SampleStamp& stamp) const {
  if (block.jumps) {
    const double tool = (stamp.tool_time - last_->tool_time).seconds();
    const double utc = (stamp.utc - last_->utc).seconds();
    sink_.OnFault(Fault{
        FaultCode::kOrder,
        fmt::format("the clock jumps before sample {} of session {}: {} samples by number, {:.3f} "
                    "s by the tool's clock, {:.3f} s by UTC; the survey goes on behind a gap",
                    stamp.seq, stamp.session, stamp.seq - last_->seq, tool, utc)});
  }
  if (block.step) {
    sink_.OnFault(Fault{
        FaultCode::kOrder,
        fmt::format("UTC steps by {:.3f} s against the tool's clock, some seconds before sample {} "
                    "of session {}: the depths from there on are in doubt",
                    *block.step, stamp.seq, stamp.session)});
  }
}

void SampleIntake::TellMended() {
  if (mended_.count == 0) return;
  sink_.OnFault(Fault{FaultCode::kRange,
                      fmt::format("{} of the samples {} to {} of session {} are impossible beside "
                                  "their neighbours and were replaced by what these say",
                                  mended_.count, mended_.first, mended_.last, mended_.session)});
  mended_.count = 0;
}

void SampleIntake::Tell(SampleQueue::Verdict verdict, const SampleStamp& stamp) {
  const auto tell = [&](FaultCode code, const char* what) {
    sink_.OnFault(
        Fault{code, fmt::format("sample {} of session {} {}", stamp.seq, stamp.session, what)});
  };
  if (verdict == SampleQueue::Verdict::kLate) {
    tell(FaultCode::kLate, "came after its time had been used");
  } else if (verdict == SampleQueue::Verdict::kRefused) {
    tell(FaultCode::kRange, "has values that no tool can measure and was left out");
  } else if (verdict == SampleQueue::Verdict::kOther) {
    const bool goes_on = other_ && other_->session == stamp.session && other_->seq + 1 == stamp.seq;
    if (!goes_on) {
      tell(FaultCode::kConflict,
           "came again with another content: it is left out, with those behind it that do so");
    }
    other_ = stamp;
  }
}

void SampleIntake::TellStrays() {
  const std::int64_t strays = queue_.counts().strays - strays_told_;
  if (strays == 0) return;
  strays_told_ += strays;
  sink_.OnFault(Fault{FaultCode::kOrder,
                      fmt::format("{} samples were left out: their numbers and times contradict "
                                  "those of the samples before and after",
                                  strays)});
}

SampleTally SampleIntake::tally() const {
  const SampleQueue::Counts& counts = queue_.counts();
  SampleTally tally{counts.accepted, lost_, gaps_, counts.duplicates, std::nullopt};
  if (counts.accepted > 0) tally.newest = queue_.newest();
  return tally;
}

}  // namespace wellgyro
