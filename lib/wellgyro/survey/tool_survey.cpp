#include "wellgyro/survey/tool_survey.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/record/limits.h"
#include "wellgyro/record/run_fit.h"
#include "wellgyro/survey/run/estimated_run.h"
#include "wellgyro/survey/tool_survey_internal.h"

namespace wellgyro {
namespace {

/// Values that a tool at rest can send; what else comes, is damage or was no rest. Gravity is 9.78
/// to 9.83 m/s^2 on the Earth and 9.90 below 15 km of it; what is left of both limits is the error
/// of an uncalibrated tool.
bool CanBe(const StillWindow& window) {
  constexpr double kRate = 0.5 * units::kDeg;  // [rad/s], 120 times the Earth's
  constexpr double kLeastForce = 9.3, kMostForce = 10.3;
  constexpr double kSeconds = 1e5;  // 28 h: no stop is longer than a day
  const double f = window.f_T.norm();
  const double seconds = window.seconds();
  const bool sigmas = window.sigma_w_IT_T.allFinite() && window.sigma_f_T.allFinite() &&
                      window.sigma_w_IT_T.minCoeff() >= 0 && window.sigma_f_T.minCoeff() >= 0 &&
                      window.sigma_w_IT_T.maxCoeff() < kRate && window.sigma_f_T.maxCoeff() < 100;
  const bool depth = !window.md || std::abs(*window.md) <= limits::kMd;
  const double turn = window.roll_rate.value_or(0), sigma_turn = window.sigma_roll_rate;
  const bool roll = std::abs(turn) < kRate && sigma_turn >= 0 && sigma_turn < kRate;
  const bool field = !window.has_mag || window.b_T.allFinite();
  return f > kLeastForce && f < kMostForce && window.w_IT_T.norm() < kRate && sigmas && depth &&
         roll && field && seconds > 0 && seconds < kSeconds;
}

}  // namespace

ToolSurvey::ToolSurvey(const Job& job, std::int32_t tool, const StringRecords& string, Sink& sink,
                       const RunAdjuster* adjuster)
    : job_(job),
      tool_(tool),
      string_(string),
      sink_(sink),
      adjuster_(adjuster),
      intake_(job, string.track, string.marks, sink),
      operations_(tool, sink),
      told_(sink) {}

std::span<const ImuSample> ToolSurvey::Take(std::span<const ImuSample> batch) {
  return intake_.Take(batch);
}

void ToolSurvey::Push(const ToolInfo& info) {
  intake_.depth().SetSensorBelowReference(info.sensor_below_reference);
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
  ToolRun* found = RunFor(string_.book.RunAt(window.utc_begin, window.run));
  if (found == nullptr) return;
  ToolRun& run = *found;
  const UtcTime middle = window.utc_begin + Duration{(window.utc_end - window.utc_begin).ns / 2};
  AlongHole along = string_.track.AtRest(window.utc_begin, window.utc_end);
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

ToolRun* ToolSurvey::RunFor(std::int32_t run) {
  const bool same = !runs_.empty() && runs_.back().survey->summary().run == run;
  return same ? &runs_.back() : FindRun(run);
}

/// From `at` on nothing is to be obeyed, and all samples are of one run and one depth scale.
bool ToolSurvey::IsUniform(const AdmittedBlock& block, std::size_t at) const {
  if (!intake_.heard()) return false;
  const UtcTime first = block.utc[at], last = block.utc[block.size() - 1];
  return !operations_.Any(block.sent.back().stamp, last) && !string_.book.Changes(first, last) &&
         string_.track.Segment(first) == string_.track.Segment(last);
}

/// Samples [at, end) of a block: one, or such as are uniform.
void ToolSurvey::Use(const AdmittedBlock& block, std::size_t at, std::size_t end) {
  const SampleStamp& stamp = block.sent[at].stamp;
  const UtcTime utc = block.utc[at];
  while (const std::optional<Operation> due = operations_.Next(stamp, utc)) {
    Obey(*due);
    if (finish_asked_) return;
  }
  if (!intake_.heard()) string_.book.HeardAt(utc);
  ToolRun* found = RunFor(string_.book.RunAt(utc, stamp.run));
  if (found == nullptr) return;
  ToolRun& run = *found;
  RunSummary& summary = run.survey->summary();
  intake_.Count(block, at, end, summary);
  newest_used_ = block.utc[end - 1];
  if (string_.book.Ended(summary.run, utc)) {
    summary.samples_after_end += static_cast<std::int64_t>(end - at);
    return;
  }
  const std::int32_t segment = string_.track.Segment(utc);
  if (segment != depth_segment_) {
    run.survey->RestartDepth();
    run.motion->Restart();
  }
  depth_segment_ = segment;
  run.watch->Push(block.samples.Part(at, end - at).samples, block.begin, at);
  Feel(block, at, end, *run.motion);
  while (at < end) {
    at = run.survey->Push(block, at, end);
    if (run.survey->has_news()) Tell(run);
  }
}

void ToolSurvey::Feel(const AdmittedBlock& block, std::size_t at, std::size_t end,
                      DepthMotion& motion) const {
  const std::size_t count = end - at;
  motion.Feel(std::span(block.utc).subspan(at, count), Duration{block.sent[at].stamp.period_ns},
              block.samples.axes.subspan(at, count), string_.track);
}

/// nullptr, and a Fault: one run too many.
ToolRun* ToolSurvey::FindRun(std::int32_t run) {
  for (ToolRun& state : runs_) {
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
  ToolRun state;
  state.survey = std::make_unique<RunSurvey>(job_, run, tool_);
  state.provisional = std::make_unique<ProvisionalPath>(job_);
  state.watch = std::make_unique<SampleWatch>(job_);
  state.motion = std::make_unique<DepthMotion>();
  runs_.push_back(std::move(state));
  return &runs_.back();
}

void ToolSurvey::Tell(ToolRun& run) {
  RunSurvey& survey = *run.survey;
  std::vector<std::size_t> news = survey.News();
  if (news.empty()) return;
  std::sort(news.begin(), news.end());
  // Once the run was solved anew the states of stations told before are others, to which those that
  // come are linked: the path begins again.
  const bool anew = run.solutions != survey.solutions();
  if (anew) run.provisional = std::make_unique<ProvisionalPath>(job_);
  run.solutions = survey.solutions();
  auto next = news.begin();
  for (std::size_t i = anew ? 0 : news.front(); i < survey.drafts().size(); ++i) {
    next = std::find_if(next, news.end(), [i](std::size_t n) { return n >= i; });
    const bool is_news = next != news.end() && *next == i;
    if (!(is_news || (anew && !survey.IsUnheard(i)))) continue;
    const Draft& draft = survey.drafts()[i];
    const StationState* state = draft.state ? &survey.state(*draft.state) : nullptr;
    std::optional<Station> station = run.provisional->Place(draft, state);
    if (!station || !is_news) continue;
    station->status = crew_.StatusOf(draft.station, false);
    told_.Tell(*station);
  }
}

void ToolSurvey::Adjust() {
  for (ToolRun& run : runs_) {
    run.survey->CloseAtDeepest();
    const RunHistory history = run.survey->History();
    if (!history.knots.empty()) {
      SmoothedRun smoothed = adjuster_ ? adjuster_->Adjust(history) : EstimatedRun(job_, history);
      run.survey->summary().fit =
          smoothed.fit ? std::make_shared<const RunFit>(*smoothed.fit) : nullptr;
      if (smoothed.fit && smoothed.fit->converged) run.survey->CloseOnWhole(smoothed);
      run.adjusted = std::move(smoothed.stations);
      run.attitude = std::move(smoothed.attitude);
    }
    run.adjusted_drafts = run.survey->drafts().size() - run.survey->ahead();
    for (Draft& draft : run.survey->drafts()) ++draft.station.revision;
  }
  for (const Station& station : Current().passes) told_.Tell(station);
}

void ToolSurvey::Flush(std::optional<UtcTime> until) {
  intake_.Flush();
  Work(until);
  intake_.TellMended();
  for (ToolRun& run : runs_) {
    run.survey->Flush();
    Tell(run);
  }
  // What people have said holds, though no sample reaches its time any more.
  for (const Operation& operation : operations_.TakeUncommanded()) Obey(operation);
}

void ToolSurvey::Finish(std::optional<UtcTime> until) {
  if (finished_) return;
  Flush(until);
  for (const Operation& operation : operations_.TakeCommands()) {
    const Command& command = std::get<Command>(operation);
    // One that no sample reached any more is obeyed by ending.
    if (command.kind == Command::Kind::kFinish && operations_.IsNew(command)) {
      sink_.OnAcknowledged(command.command_id);
    }
  }
  Adjust();
  finished_ = true;
  for (const ToolRun& run : runs_) {
    const auto found = Contradiction(job_, run.survey->summary());
    if (!found) continue;
    const std::string by =
        found->md ? fmt::format("the north found at MD {:.2f} m", *found->md) : "the norths found";
    sink_.OnFault(
        Fault{FaultCode::kConflict,
              fmt::format("run {}: the job's azimuth is {:.1f} sigmas from {}: one of them is "
                          "wrong, and every station of the run with it",
                          run.survey->summary().run, found->sigmas, by)});
  }
  for (const Check& check : Current().checks) sink_.OnCheck(check);
}

Survey ToolSurvey::Current() const {
  const SurveyParts parts{runs_, crew_, told_, intake_.counts(), newest_used_, finished_};
  return SurveyMaker(job_, string_, parts).Make();
}

std::optional<UtcTime> ToolSurvey::begin() const {
  if (runs_.empty()) return std::nullopt;
  const RunSummary& first = runs_.front().survey->summary();
  return first.samples > 0 ? std::optional(first.begin) : std::nullopt;
}

RunNow ToolSurvey::Now() const { return runs_.empty() ? RunNow() : runs_.back().survey->Now(); }

}  // namespace wellgyro
