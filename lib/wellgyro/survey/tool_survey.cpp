#include "wellgyro/survey/tool_survey.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/survey/estimated_run.h"
#include "wellgyro/survey/tool_survey_internal.h"

namespace wellgyro {
namespace {

// Modes, and commands and events, that wait for their time; more come from a broken sender alone.
constexpr std::ptrdiff_t kDueMax = 1000;
// An accepted or rejected depth is typed by hand, to the decimetre at best.
constexpr double kTypedDepth = 0.5;  // [m]

/// At the least a sample waits for the depth marks after it that decide its depth, each as late as
/// it may be.
Duration Hold(const DepthTrack& track) {
  return track.latency() + track.ahead() + DepthGrid::kStep;
}

UtcTime TimeOf(const Operation& operation) {
  return std::visit([](const auto& record) { return record.utc; }, operation);
}

/// Values that a tool at rest can send; what else comes, is damage or was no rest. Gravity is 9.78
/// to 9.83 m/s^2 on the Earth and 9.90 below 15 km of it; what is left of both limits is the error
/// of an uncalibrated tool.
bool CanBe(const StillWindow& window) {
  constexpr double kRate = 0.5 * units::kDeg;  // [rad/s]
  constexpr double kLeastForce = 9.3, kMostForce = 10.3;
  constexpr double kDepthMost = 1e5;  // [m]
  constexpr double kSeconds = 1e5;
  const double f = window.f_T.norm();
  const double seconds = window.seconds();
  const bool sigmas = window.sigma_w_IT_T.allFinite() && window.sigma_f_T.allFinite() &&
                      window.sigma_w_IT_T.minCoeff() >= 0 && window.sigma_f_T.minCoeff() >= 0 &&
                      window.sigma_w_IT_T.maxCoeff() < kRate && window.sigma_f_T.maxCoeff() < 100;
  const bool depth = !window.md || std::abs(*window.md) < kDepthMost;
  return f > kLeastForce && f < kMostForce && window.w_IT_T.norm() < kRate && sigmas && depth &&
         seconds > 0 && seconds < kSeconds;
}

/// What the accelerometers feel along the tool, less what the inclination changes of gravity's
/// share of it, which the force across tells; within 12 deg of horizontal it does not.
double FeltAlong(const Eigen::Vector3d& f_T) {
  constexpr double kFlat = 0.2, kG = units::kStandardGravity;
  const double across = f_T.head<2>().squaredNorm() / (kG * kG);
  const double cosine = std::sqrt(std::max(1 - across, 0.0));
  return f_T.z() - std::copysign(kG * std::max(cosine - kFlat, 0.0), f_T.z());
}

double Correction(const std::vector<std::pair<double, double>>& table, double md) {
  if (table.empty()) return 0;
  const auto after = std::upper_bound(table.begin(), table.end(), md,
                                      [](double x, const auto& row) { return x < row.first; });
  if (after == table.begin()) return table.front().second;
  if (after == table.end()) return table.back().second;
  const auto& [x1, y1] = *after;
  const auto& [x0, y0] = *std::prev(after);
  return y0 + (md - x0) / (x1 - x0) * (y1 - y0);
}

}  // namespace

ToolSurvey::ToolSurvey(const Job& job, std::int32_t tool, const DepthTrack& track,
                       const MarksRefused& refused, CableMarks& marks, RunBook& book, Sink& sink,
                       const RunAdjuster* adjuster)
    : job_(job),
      tool_(tool),
      track_(track),
      refused_(refused),
      grid_(track),
      marks_(marks),
      book_(book),
      sink_(sink),
      adjuster_(adjuster),
      corrects_depth_(!job.depth.corrections.empty() || job.depth.cable.mark_spacing > 0),
      sensor_below_reference_(job.string.sensor_below_reference),
      queue_(Hold(track)),
      filter_(job.noise, job.errors) {}

std::span<const ImuSample> ToolSurvey::Take(std::span<const ImuSample> batch) {
  if (const std::size_t taken = queue_.Append(batch); taken > 0) return batch.subspan(taken);
  // What is ready goes on before another is sorted in, which must not depend on the batches.
  const ImuSample& sample = batch.front();
  const SampleQueue::Verdict verdict = queue_.Push(sample);
  if (verdict != SampleQueue::Verdict::kTaken) TellRefused(verdict, sample.stamp);
  TellStrays();
  return batch.subspan(1);
}

void ToolSurvey::TellRefused(SampleQueue::Verdict verdict, const SampleStamp& stamp) {
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

void ToolSurvey::TellStrays() {
  const std::int64_t strays = queue_.counts().strays - strays_told_;
  if (strays == 0) return;
  strays_told_ += strays;
  sink_.OnFault(Fault{FaultCode::kOrder,
                      fmt::format("{} samples were left out: their numbers and times contradict "
                                  "those of the samples before and after",
                                  strays)});
}

/// Modes do not take the place of what people say. Of too many, the latest is left out; false: that
/// is `due` itself.
bool ToolSurvey::MakeRoom(const Due& due) {
  const bool mode = std::holds_alternative<ToolMode>(due.operation);
  const auto alike = [mode](const Due& d) {
    return std::holds_alternative<ToolMode>(d.operation) == mode;
  };
  if (std::count_if(due_.begin(), due_.end(), alike) < kDueMax) return true;
  sink_.OnFault(Fault{FaultCode::kRange,
                      fmt::format("more than {} {} wait for samples of tool {}: one is left out",
                                  kDueMax, mode ? "modes" : "commands and events", tool_)});
  const auto last = std::find_if(due_.rbegin(), due_.rend(), alike);
  if (!mode || last->utc <= due.utc) return false;
  due_.erase(std::next(last).base());
  return true;
}

void ToolSurvey::Push(const Operation& operation) {
  const Due due{TimeOf(operation), operation};
  if (!MakeRoom(due)) return;
  const auto after = std::upper_bound(due_.begin(), due_.end(), due.utc,
                                      [](UtcTime utc, const Due& d) { return utc < d.utc; });
  due_.insert(after, due);
}

void ToolSurvey::Push(const StillWindow& window) {
  if (!CanBe(window)) {
    sink_.OnFault(
        Fault{FaultCode::kRange,
              fmt::format("the averages at rest of {} s cannot be those of a tool at rest "
                          "and were left out",
                          window.utc_begin.ns / 1'000'000'000)});
    return;
  }
  RunState* found = RunFor(book_.RunAt(window.utc_begin, window.run));
  if (found == nullptr) return;
  RunState& run = *found;
  const UtcTime middle = window.utc_begin + Duration{(window.utc_end - window.utc_begin).ns / 2};
  AlongHole along = track_.AtRest(window.utc_begin, window.utc_end);
  ShiftToSensor(middle, along);
  if (!window.md && !along.known) TellWithoutDepth(window);
  run.survey->Push(window, along);
  Tell(run);
}

void ToolSurvey::TellWithoutDepth(const StillWindow& window) {
  sink_.OnFault(Fault{FaultCode::kLost,
                      fmt::format("the averages at rest of {} to {} s have no depth and make no "
                                  "station: no marks about them that agree within 2 cm and leave "
                                  "no more than [depth] max_gap_s = {} outside the rest",
                                  window.utc_begin.ns / 1'000'000'000,
                                  window.utc_end.ns / 1'000'000'000, job_.depth.max_gap)});
}

/// A mark of the time m has come by a sample of m + latency.
bool ToolSurvey::DepthIsFinal(const SampleStamp& stamp) {
  if (queue_.hurries()) return true;
  const UtcTime utc = clock_.Expected(stamp), until = utc + queue_.age() - track_.latency();
  const UtcTime middle = utc + Duration{stamp.period_ns / 2};
  return grid_.Knows(utc, until) && grid_.Knows(middle, until);
}

void ToolSurvey::Work(std::optional<UtcTime> until) {
  while (const ImuSample* sample = queue_.Front()) {
    if (!DepthIsFinal(sample->stamp)) return;
    const bool after = finish_asked_ || (until && sample->stamp.utc >= *until);
    if (!after) {
      const bool jumps = queue_.Jumps();
      if (jumps || !filter_.Continues(sample->stamp)) UseRest();
      if (const SpikeFilter::Out* out = filter_.Push(*sample, jumps)) Use(*out);
    }
    queue_.Pop();
  }
}

/// What the filter still holds: the samples that end a stretch without gaps.
void ToolSurvey::UseRest() {
  while (const SpikeFilter::Out* out = filter_.Flush()) Use(*out);
}

/// One fault for all that lie near each other.
void ToolSurvey::TellMended(const SpikeFilter::Out& out, RunSummary& summary) {
  summary.samples_gyro_mended += out.gyro;
  summary.samples_accel_mended += out.accel;
  constexpr std::int64_t kNear = 10'000'000'000;  // [ns]
  const SampleStamp& stamp = out.sample.stamp;
  const bool joins = mended_.count > 0 && mended_.session == stamp.session &&
                     (stamp.seq - mended_.last) * stamp.period_ns < kNear;
  if (!joins) {
    TellMendedRange();
    mended_ = {stamp.session, stamp.seq, stamp.seq, 0};
  }
  mended_.last = stamp.seq;
  ++mended_.count;
}

void ToolSurvey::TellMendedRange() {
  if (mended_.count == 0) return;
  sink_.OnFault(Fault{FaultCode::kRange,
                      fmt::format("{} of the samples {} to {} of session {} are impossible beside "
                                  "their neighbours and were replaced by what these say",
                                  mended_.count, mended_.first, mended_.last, mended_.session)});
  mended_.count = 0;
}

void ToolSurvey::CountLost(const SampleStamp& stamp, RunSummary& summary) {
  if (stamp.session != last_->session || stamp.seq <= last_->seq + 1) return;
  const std::int64_t lost = stamp.seq - last_->seq - 1;
  summary.samples_lost += lost;
  lost_ += lost;
  ++gaps_;
  sink_.OnFault(Fault{FaultCode::kLost, fmt::format("samples {} to {} of session {} are missing",
                                                    last_->seq + 1, stamp.seq - 1, stamp.session)});
}

inline ToolSurvey::RunState* ToolSurvey::RunFor(std::int32_t run) {
  const bool same = !runs_.empty() && runs_.back().survey->summary().run == run;
  return same ? &runs_.back() : FindRun(run);
}

/// A clock that jumps within a session, or a UTC that steps against it.
void ToolSurvey::TellClock(const SampleStamp& stamp, bool jumps, RunSummary& summary) {
  if (jumps) {
    const double tool = (stamp.tool_time - last_->tool_time).seconds();
    const double utc = (stamp.utc - last_->utc).seconds();
    sink_.OnFault(Fault{
        FaultCode::kOrder,
        fmt::format("the clock jumps before sample {} of session {}: {} samples by number, {:.3f} "
                    "s by the tool's clock, {:.3f} s by UTC; the survey goes on behind a gap",
                    stamp.seq, stamp.session, stamp.seq - last_->seq, tool, utc)});
  }
  if (clock_.step()) {
    sink_.OnFault(Fault{
        FaultCode::kOrder,
        fmt::format("UTC steps by {:.3f} s against the tool's clock, some seconds before sample {} "
                    "of session {}: the depths from there on are in doubt",
                    *clock_.step(), stamp.seq, stamp.session)});
  }
  summary.clock_jumps += (jumps ? 1 : 0) + (clock_.step() ? 1 : 0);
}

void ToolSurvey::Use(const SpikeFilter::Out& out) {
  if (finish_asked_) return;
  const ImuSample& sample = out.sample;
  const bool jumps = out.mark;
  const SampleStamp& stamp = sample.stamp;
  const SampleStamp& continued = clock_.Take(stamp, jumps);
  const UtcTime utc = clock_.utc();
  if (!due_.empty() && !ObeyDue(stamp, utc)) return;
  if (!last_) book_.HeardAt(utc);
  RunState* found = RunFor(book_.RunAt(utc, stamp.run));
  if (found == nullptr) return;
  RunState& run = *found;
  if (out.gyro || out.accel) TellMended(out, run.survey->summary());
  if (last_ && !jumps && stamp.seq != last_->seq + 1) CountLost(stamp, run.survey->summary());
  if (jumps || clock_.step()) TellClock(stamp, jumps, run.survey->summary());
  last_ = stamp;
  if (book_.Ended(run.survey->summary().run, utc)) {
    ++run.survey->summary().samples_after_end;
    newest_used_ = utc;
    return;
  }
  const std::int32_t segment = track_.Segment(utc);
  if (segment != depth_segment_) {
    run.survey->RestartDepth();
    run.motion->Restart();
  }
  depth_segment_ = segment;
  const UtcTime utc_middle = utc + Duration{stamp.period_ns / 2};
  AlongHole begin = grid_.At(utc), middle = grid_.At(utc_middle);
  ShiftToSensor(utc, begin);
  ShiftToSensor(utc_middle, middle);
  if (!clock_.own()) {
    changed_ = sample;
    changed_.stamp = continued;
  }
  run.watch->Push(sample, begin);
  run.motion->Feel(utc, 1e-9 * stamp.period_ns, FeltAlong(sample.f_T), track_);
  run.survey->Push(clock_.own() ? sample : changed_, utc, begin, middle);
  newest_used_ = utc;
  if (run.survey->has_news()) Tell(run);
}

inline void ToolSurvey::ShiftToSensor(UtcTime utc, AlongHole& along) const {
  if (!along.known) return;
  double below = sensor_below_reference_;
  if (corrects_depth_) {
    along.md += marks_.At(utc, along.md);
    below += Correction(job_.depth.corrections, along.md);
  }
  along.md += below;
  // What the string moved in the time by which UTC may be wrong.
  if (clock_.doubt() > 0) {
    along.sigma_md = std::hypot(along.sigma_md, clock_.doubt() * along.speed);
  }
}

/// nullptr, and a Fault: one run too many.
ToolSurvey::RunState* ToolSurvey::FindRun(std::int32_t run) {
  for (RunState& state : runs_) {
    if (state.survey->summary().run != run) continue;
    // Another run may have begun since and ended; its samples are not mixed with these.
    return &state;
  }
  if (runs_.size() >= Surveyor::kRunsMax) {
    sink_.OnFault(Fault{FaultCode::kRange, fmt::format("run {} is one more than {}: it is left out",
                                                       run, Surveyor::kRunsMax)});
    return nullptr;
  }
  if (!runs_.empty()) {
    runs_.back().survey->Flush();
    Tell(runs_.back());
  }
  RunState state;
  state.survey = std::make_unique<RunSurvey>(job_, run, tool_);
  state.provisional = std::make_unique<ProvisionalPath>(job_);
  state.watch = std::make_unique<SampleWatch>(job_);
  state.motion = std::make_unique<DepthMotion>();
  runs_.push_back(std::move(state));
  return &runs_.back();
}

void ToolSurvey::Tell(RunState& run) {
  RunSurvey& survey = *run.survey;
  std::vector<std::size_t> news = survey.News();
  if (news.empty()) return;
  std::sort(news.begin(), news.end());
  for (std::size_t i : news) {
    Draft& draft = survey.drafts()[i];
    const StationState* state = draft.state ? &survey.state(*draft.state) : nullptr;
    if (std::optional<Station> station = run.provisional->Place(draft, state)) {
      station->status = StatusOf(draft, false);
      TellStation(*station);
    }
  }
}

StationStatus ToolSurvey::StatusOf(const Draft& draft, bool adjusted) const {
  StationStatus status = adjusted ? StationStatus::kField : StationStatus::kProvisional;
  const Station& s = draft.station;
  for (const Event& event : verdicts_) {
    if (event.run != 0 && event.run != s.run) continue;
    if (event.has_value && std::abs(event.value_m - s.md) > kTypedDepth) continue;
    status =
        event.kind == Event::Kind::kAccept ? StationStatus::kDefinitive : StationStatus::kRejected;
  }
  return status;
}

void ToolSurvey::Adjust() {
  for (RunState& run : runs_) {
    run.survey->ListLastDepth();
    const RunHistory history = run.survey->History();
    if (!history.knots.empty()) {
      SmoothedRun smoothed = adjuster_ ? adjuster_->Adjust(history) : EstimatedRun(job_, history);
      run.survey->summary().fit = smoothed.fit;
      if (smoothed.fit && smoothed.fit->converged) run.survey->CloseOnWhole(smoothed.attitude);
      run.adjusted = std::move(smoothed.stations);
      run.attitude = std::move(smoothed.attitude);
    }
    run.adjusted_drafts = run.survey->drafts().size() - run.survey->ahead();
    for (Draft& draft : run.survey->drafts()) ++draft.station.revision;
  }
  SendRevisions();
}

void ToolSurvey::SendRevisions() {
  const Survey survey = Current();
  for (const Station& station : survey.passes) TellStation(station);
}

void ToolSurvey::TellStation(const Station& station) {
  told_.insert_or_assign(KeyOf(station), station);
  sink_.OnStation(station);
}

void ToolSurvey::Flush(std::optional<UtcTime> until) {
  queue_.Flush();
  TellStrays();
  Work(until);
  UseRest();
  TellMendedRange();
  for (RunState& run : runs_) {
    run.survey->Flush();
    Tell(run);
  }
  // What people have said holds, though no sample reaches its time any more.
  const auto commands = std::stable_partition(due_.begin(), due_.end(), [](const Due& due) {
    return !std::holds_alternative<Command>(due.operation);
  });
  std::for_each(due_.begin(), commands, [this](const Due& due) { Obey(due.operation); });
  due_.erase(due_.begin(), commands);
}

void ToolSurvey::Finish(std::optional<UtcTime> until) {
  if (finished_) return;
  Flush(until);
  for (const Due& due : std::exchange(due_, {})) {
    const Command& command = std::get<Command>(due.operation);
    // One that no sample reached any more is obeyed by ending.
    if (command.kind == Command::Kind::kFinish &&
        (command.command_id == 0 ||
         commands_.insert({command.session, command.command_id}).second)) {
      sink_.OnAcknowledged(command.command_id);
    }
  }
  Adjust();
  finished_ = true;
  for (const RunState& run : runs_) {
    const NorthFix* fix = Contradiction(job_, run.survey->summary());
    if (fix == nullptr) continue;
    sink_.OnFault(
        Fault{FaultCode::kConflict,
              fmt::format(
                  "run {}: the job's azimuth is {:.1f} sigmas from the north found at MD {:.2f} m: "
                  "one of them is wrong, and every station of the run with it",
                  run.survey->summary().run, std::sqrt(*fix->chi_square), fix->md.value_or(0))});
  }
  for (const Check& check : Current().checks) sink_.OnCheck(check);
}

SampleTally ToolSurvey::tally() const {
  const SampleQueue::Counts& counts = queue_.counts();
  SampleTally tally{counts.accepted, lost_, gaps_, counts.duplicates, std::nullopt};
  if (counts.accepted > 0) tally.newest = queue_.newest();
  return tally;
}

RunNow ToolSurvey::Now() const { return runs_.empty() ? RunNow() : runs_.back().survey->Now(); }

}  // namespace wellgyro
