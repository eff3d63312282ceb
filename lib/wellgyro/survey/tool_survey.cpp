#include "wellgyro/survey/tool_survey.h"

#include <algorithm>
#include <array>
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

}  // namespace

ToolSurvey::ToolSurvey(const Job& job, std::int32_t tool, const DepthTrack& track,
                       const MarksRefused& refused, CableMarks& marks, RunBook& book, Sink& sink,
                       const RunAdjuster* adjuster)
    : job_(job),
      tool_(tool),
      track_(track),
      refused_(refused),
      marks_(marks),
      book_(book),
      sink_(sink),
      adjuster_(adjuster),
      intake_(job, track, marks, sink) {}

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
  intake_.depth().ShiftToSensor(middle, intake_.clock_doubt(), along);
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

void ToolSurvey::Work(std::optional<UtcTime> until) {
  while (!finish_asked_) {
    const AdmittedBlock* block = intake_.Next(until);
    if (block == nullptr) return;
    for (std::size_t at = 0; at < block->size() && !finish_asked_;) {
      const std::size_t end = IsUniform(*block, at) ? block->size() : at + 1;
      Use(*block, at, end);
      at = end;
    }
  }
}

inline ToolSurvey::RunState* ToolSurvey::RunFor(std::int32_t run) {
  const bool same = !runs_.empty() && runs_.back().survey->summary().run == run;
  return same ? &runs_.back() : FindRun(run);
}

/// From `at` on nothing is to be obeyed, and all samples are of one run and one depth scale.
bool ToolSurvey::IsUniform(const AdmittedBlock& block, std::size_t at) const {
  if (!intake_.heard()) return false;
  const SampleStamp& stamp = block.sent.back().stamp;
  const UtcTime first = block.utc[at], last = block.utc[block.size() - 1];
  if (!due_.empty() && (due_.front().utc <= last || IsDue(due_.front(), stamp, last))) return false;
  const std::int32_t run = book_.RunAt(first, stamp.run);
  return run == book_.RunAt(last, stamp.run) && book_.Ended(run, first) == book_.Ended(run, last) &&
         track_.Segment(first) == track_.Segment(last);
}

/// Samples [at, end) of a block: one, or such as are uniform.
void ToolSurvey::Use(const AdmittedBlock& block, std::size_t at, std::size_t end) {
  const SampleStamp& stamp = block.sent[at].stamp;
  const UtcTime utc = block.utc[at];
  if (!due_.empty() && !ObeyDue(stamp, utc)) return;
  if (!intake_.heard()) book_.HeardAt(utc);
  RunState* found = RunFor(book_.RunAt(utc, stamp.run));
  if (found == nullptr) return;
  RunState& run = *found;
  RunSummary& summary = run.survey->summary();
  intake_.Count(block, at, end, summary);
  newest_used_ = block.utc[end - 1];
  if (book_.Ended(summary.run, utc)) {
    summary.samples_after_end += static_cast<std::int64_t>(end - at);
    return;
  }
  const std::int32_t segment = track_.Segment(utc);
  if (segment != depth_segment_) {
    run.survey->RestartDepth();
    run.motion->Restart();
  }
  depth_segment_ = segment;
  run.watch->Push(block.sent.subspan(at, end - at), block.begin, at);
  Feel(block, at, end, *run.motion);
  while (at < end) {
    at = run.survey->Push(block, at, end);
    if (run.survey->has_news()) Tell(run);
  }
}

void ToolSurvey::Feel(const AdmittedBlock& block, std::size_t at, std::size_t end,
                      DepthMotion& motion) const {
  std::array<double, SampleBlock::kMost> felt;
  const std::size_t count = end - at;
  for (std::size_t i = 0; i < count; ++i) felt[i] = FeltAlong(block.samples.axes[at + i].tail<3>());
  motion.Feel(std::span(block.utc).subspan(at, count), Duration{block.sent[at].stamp.period_ns},
              std::span(felt).first(count), track_);
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
  intake_.Flush();
  Work(until);
  intake_.TellMended();
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

RunNow ToolSurvey::Now() const { return runs_.empty() ? RunNow() : runs_.back().survey->Now(); }

}  // namespace wellgyro
