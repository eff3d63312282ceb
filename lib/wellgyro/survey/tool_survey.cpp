#include "wellgyro/survey/tool_survey.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/attitude/smoother.h"
#include "wellgyro/survey/choose.h"
#include "wellgyro/survey/hole_attitude.h"
#include "wellgyro/survey/joined_states.h"
#include "wellgyro/survey/model_covariance.h"
#include "wellgyro/survey/station_of.h"

namespace wellgyro {
namespace {

// Commands, modes and events that wait for their time; more come from a broken sender alone.
constexpr std::size_t kDueMax = 2000;
// An accepted or rejected depth is typed by hand, to the decimetre at best.
constexpr double kTypedDepth = 0.5;  // [m]
// A foresight holds at a knot no further away than this.
constexpr double kForesightSeconds = 2;
// From so many sigmas on two norths are not both right.
constexpr double kContradiction = 4;
// So long after the last sample or mark a tool that was at rest then still hangs as it did.
constexpr Duration kHeld = Duration::Seconds(600);
constexpr double kHeldSpeed = 0.006;  // [m/s], that of the still detector

/// Depth marks of a second and more after a sample decide its depth; so long it waits for them.
Duration Hold(const Job& job, const DepthTrack& track) {
  return Duration::Seconds(job.depth.latency) + track.wait() + DepthGrid::kStep;
}

UtcTime TimeOf(const Operation& operation) {
  return std::visit([](const auto& record) { return record.utc; }, operation);
}

/// Near vertical the hole's direction is known without an azimuth.
bool HasDirection(const AttitudeSample& attitude) {
  return attitude.azimuth_known || Has(attitude.quality, Quality::kVertical);
}

/// Values that a tool at rest can send; what else comes, is damage.
bool CanBe(const StillWindow& window) {
  constexpr double kRate = 1;     // [rad/s]
  constexpr double kDepth = 1e5;  // [m]
  constexpr double kSeconds = 1e5;
  const double f = window.f_T.norm();
  const double seconds = window.seconds();
  const bool sigmas = window.sigma_w_IT_T.allFinite() && window.sigma_f_T.allFinite() &&
                      window.sigma_w_IT_T.minCoeff() >= 0 && window.sigma_f_T.minCoeff() >= 0 &&
                      window.sigma_w_IT_T.maxCoeff() < kRate && window.sigma_f_T.maxCoeff() < 100;
  const bool depth = !window.md || std::abs(*window.md) < kDepth;
  return f > 5 && f < 20 && window.w_IT_T.norm() < kRate && sigmas && depth && seconds > 0 &&
         seconds < kSeconds;
}

/// The north fix that contradicts the job's external azimuth most, where one does.
const NorthFix* Contradiction(const Job& job, const RunSummary& run) {
  if (job.alignment.method != AlignmentSpec::Method::kExternal) return nullptr;
  const NorthFix* worst = nullptr;
  for (const NorthFix& fix : run.fixes) {
    if (fix.external || !fix.chi_square || Has(fix.quality, Quality::kVertical)) continue;
    if (*fix.chi_square < kContradiction * kContradiction) continue;
    if (worst == nullptr || *fix.chi_square > *worst->chi_square) worst = &fix;
  }
  return worst;
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
                       CableMarks& marks, RunBook& book, Sink& sink, const RunAdjuster* adjuster)
    : job_(job),
      tool_(tool),
      track_(track),
      grid_(track),
      marks_(marks),
      book_(book),
      sink_(sink),
      adjuster_(adjuster),
      sensor_below_reference_(job.string.sensor_below_reference),
      queue_(Hold(job, track)) {}

void ToolSurvey::Push(const ImuSample& sample) {
  if (queue_.Push(sample) == SampleQueue::Verdict::kLate) {
    sink_.OnFault(Fault{FaultCode::kLate,
                        fmt::format("sample {} of session {} came after its time had been used",
                                    sample.stamp.seq, sample.stamp.session)});
  }
  Work();
}

void ToolSurvey::Push(const Operation& operation) {
  if (due_.size() >= kDueMax) {
    sink_.OnFault(Fault{FaultCode::kRange, fmt::format("more than {} commands, modes and events "
                                                       "wait for samples of tool {}: one is left "
                                                       "out",
                                                       kDueMax, tool_)});
    return;
  }
  const Due due{TimeOf(operation), operation};
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
  AlongHole along = track_.At(middle);
  ShiftToSensor(middle, along);
  run.survey->Push(window, along);
  Tell(run);
}

void ToolSurvey::Work() {
  while (const ImuSample* sample = queue_.Front()) {
    if (!finish_asked_) Use(*sample);
    queue_.Pop();
  }
}

bool ToolSurvey::IsDue(const Due& due, const SampleStamp& stamp, UtcTime utc) const {
  if (const auto* mode = std::get_if<ToolMode>(&due.operation)) {
    if (mode->imu_seq && mode->session == stamp.session) return *mode->imu_seq <= stamp.seq;
  }
  return due.utc <= utc;
}

void ToolSurvey::Use(const ImuSample& sample) {
  const SampleStamp& stamp = sample.stamp;
  tie_.Push(stamp);
  const UtcTime utc = tie_.ToUtc(stamp.tool_time);
  for (std::size_t i = 0; i < due_.size();) {
    if (!IsDue(due_[i], stamp, utc)) {
      // A mode may wait for its sample longer than its time says; nothing else does.
      if (due_[i].utc > utc) break;
      ++i;
      continue;
    }
    const Operation operation = due_[i].operation;
    due_.erase(due_.begin() + static_cast<std::ptrdiff_t>(i));
    Obey(operation);
    if (finish_asked_) return;
  }
  if (!last_) book_.HeardAt(utc);
  RunState* found = RunFor(book_.RunAt(utc, stamp.run));
  if (found == nullptr) return;
  RunState& run = *found;
  if (last_ && stamp.session == last_->session && stamp.seq > last_->seq + 1) {
    const std::int64_t lost = stamp.seq - last_->seq - 1;
    run.survey->summary().samples_lost += lost;
    lost_ += lost;
    ++gaps_;
    sink_.OnFault(
        Fault{FaultCode::kLost, fmt::format("samples {} to {} of session {} are missing",
                                            last_->seq + 1, stamp.seq - 1, stamp.session)});
  }
  last_ = stamp;
  if (book_.Ended(run.survey->summary().run, utc)) {
    ++run.survey->summary().samples_after_end;
    newest_used_ = utc;
    return;
  }
  const std::int32_t segment = track_.Segment(utc);
  if (segment != depth_segment_) run.survey->RestartDepth();
  depth_segment_ = segment;
  const UtcTime utc_middle = utc + Duration{stamp.period_ns / 2};
  AlongHole begin = grid_.At(utc), middle = grid_.At(utc_middle);
  ShiftToSensor(utc, begin);
  ShiftToSensor(utc_middle, middle);
  run.survey->Push(sample, utc, begin, middle);
  newest_used_ = utc;
  if (run.survey->has_news()) Tell(run);
}

/// The track's depth; after its last mark, that of a string which stood when it came.
AlongHole ToolSurvey::DepthHeldAt(UtcTime utc) const {
  const AlongHole along = track_.At(utc);
  if (along.known || track_.empty()) return along;
  const UtcTime last = track_.newest();
  if (utc < last || utc - last > kHeld) return along;
  const AlongHole end = track_.At(last);
  return std::abs(end.speed) <= kHeldSpeed ? end : along;
}

inline void ToolSurvey::ShiftToSensor(UtcTime utc, AlongHole& along) const {
  if (!along.known) return;
  along.md += marks_.At(utc, along.md);
  const auto& table = job_.depth.corrections;
  along.md += (table.empty() ? 0 : Correction(table, along.md)) + sensor_below_reference_;
}

/// nullptr, and a Fault: one run too many.
ToolSurvey::RunState* ToolSurvey::RunFor(std::int32_t run) {
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
  runs_.push_back(std::move(state));
  return &runs_.back();
}

void ToolSurvey::Obey(const Operation& operation) {
  std::visit([this](const auto& record) { Obey(record); }, operation);
}

void ToolSurvey::Obey(const ToolMode& mode) {
  const bool changes =
      !mode_ || mode_->mode != mode.mode || mode_->index_position != mode.index_position;
  mode_ = mode;
  if (changes && !runs_.empty()) runs_.back().survey->Cut(mode.index_position);
}

void ToolSurvey::Obey(const Event& event) {
  if (event.event_id != 0 && !events_.insert(event.event_id).second) return;
  const std::int32_t run = book_.RunAt(event.utc, event.run);
  switch (event.kind) {
    case Event::Kind::kAccept:
    case Event::Kind::kReject:
      verdicts_.push_back(event);
      break;
    case Event::Kind::kForesight:
      foresights_.push_back(event);
      foresights_.back().run = run;
      break;
    case Event::Kind::kReturnToZero: {
      const AlongHole along = DepthHeldAt(event.utc);
      ReturnToZero back{run, {}, event.has_value ? event.value_m : 0, event.sigma_m};
      if (along.known) back.read_md = along.md;
      returns_.push_back(back);
      break;
    }
    default:
      break;  // depth events work in the depth track, run events in the run book
  }
}

void ToolSurvey::Obey(const Command& command) {
  if (command.command_id != 0 && !commands_.insert(command.command_id).second) return;
  switch (command.kind) {
    case Command::Kind::kTakeStation:
      if (!runs_.empty()) runs_.back().survey->TakeStation(command.md);
      break;
    case Command::Kind::kAdjust:
      Adjust();
      break;
    case Command::Kind::kFinish:
      finish_asked_ = command.utc;
      break;
    default:
      break;  // the others are for the tool
  }
  sink_.OnAcknowledged(command.command_id);
}

void ToolSurvey::Tell(RunState& run) {
  RunSurvey& survey = *run.survey;
  std::vector<std::size_t> news = survey.News();
  if (news.empty()) return;
  std::sort(news.begin(), news.end());
  const std::vector<StationState>* states =
      survey.filter() ? &survey.filter()->stations() : nullptr;
  SmoothedRun smoothed;
  // Stations from before the first north get their azimuth from it.
  const bool backwards = std::any_of(news.begin(), news.end(), [&](std::size_t i) {
    const Draft& draft = survey.drafts()[i];
    return draft.state && !(*states)[*draft.state].attitude.azimuth_known;
  });
  if (backwards) {
    smoothed = Smooth(survey.filter()->history());
    run.backwards = smoothed.stations;
    states = &smoothed.stations;
  }
  for (std::size_t i : news) {
    Draft& draft = survey.drafts()[i];
    const StationState* state = draft.state ? &(*states)[*draft.state] : nullptr;
    if (std::optional<Station> station = run.provisional->Place(draft, state)) {
      station->status = StatusOf(draft, false);
      sink_.OnStation(*station);
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
    if (const AzimuthFilter* filter = run.survey->filter()) {
      SmoothedRun smoothed =
          adjuster_ ? adjuster_->Adjust(filter->history(), job_.string.sigma_misalignment)
                    : Smooth(filter->history());
      run.adjusted = std::move(smoothed.stations);
      run.attitude = std::move(smoothed.attitude);
    }
    run.adjusted_drafts = run.survey->drafts().size();
    for (Draft& draft : run.survey->drafts()) ++draft.station.revision;
  }
  SendRevisions();
}

void ToolSurvey::SendRevisions() {
  const Placed placed = Assemble(job_, Drafted());
  for (const Station& station : placed.passes) sink_.OnStation(station);
}

void ToolSurvey::Finish(std::optional<UtcTime> until) {
  if (finished_) return;
  queue_.Flush();
  while (const ImuSample* sample = queue_.Front()) {
    const bool after = (until && sample->stamp.utc >= *until) || finish_asked_;
    if (!after) Use(*sample);
    queue_.Pop();
  }
  for (RunState& run : runs_) {
    run.survey->Flush();
    Tell(run);
  }
  const std::vector<Due> rest = std::exchange(due_, {});
  for (const Due& due : rest) {
    const auto* command = std::get_if<Command>(&due.operation);
    if (command == nullptr) Obey(due.operation);
    // One that no sample reached any more is obeyed by ending.
    if (command != nullptr && command->kind == Command::Kind::kFinish &&
        (command->command_id == 0 || commands_.insert(command->command_id).second)) {
      sink_.OnAcknowledged(command->command_id);
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

/// Where the hole points at every knot that has a depth and a direction.
std::vector<Waypoint> ToolSurvey::WayOf(const RunState& run) const {
  std::vector<Waypoint> way;
  const std::vector<FilterEpoch>& epochs = run.survey->filter()->history().epochs;
  way.reserve(epochs.size());
  for (std::size_t i = 0; i < epochs.size(); ++i) {
    const FilterEpoch& epoch = epochs[i];
    AttitudeSample attitude;
    if (i < run.attitude.size()) {
      attitude = run.attitude[i];
    } else {
      attitude.inclination = epoch.knot.inclination;
      attitude.azimuth = epoch.azimuth;
      attitude.toolface = epoch.knot.toolface;
      attitude.azimuth_known = epoch.azimuth_known;
      if (epoch.knot.vertical) attitude.quality |= Quality::kVertical;
    }
    if (!epoch.knot.along.known || !HasDirection(attitude)) continue;
    const HoleAttitude hole = AttitudeOfHole(attitude, job_.string);
    way.push_back({epoch.knot.utc, {epoch.knot.along.md, hole.inclination, hole.azimuth}});
  }
  return way;
}

std::vector<DraftedRun> ToolSurvey::Drafted() const {
  std::vector<DraftedRun> drafted;
  for (const RunState& run : runs_) {
    DraftedRun d;
    d.run = run.survey->summary().run;
    d.misrun = book_.misrun(d.run);
    if (const AzimuthFilter* filter = run.survey->filter()) {
      d.states = JoinStates(run.adjusted, run.backwards, filter->stations());
      d.way = WayOf(run);
    }
    const bool contradicted = Contradiction(job_, run.survey->summary()) != nullptr;
    for (std::size_t i = 0; i < run.survey->drafts().size(); ++i) {
      Draft draft = run.survey->drafts()[i];
      if (contradicted) draft.station.quality |= Quality::kEarthRate;
      if (draft.state && !HasDirection(d.states[*draft.state].attitude)) continue;
      draft.station.status = StatusOf(draft, i < run.adjusted_drafts);
      d.drafts.push_back(std::move(draft));
    }
    drafted.push_back(std::move(d));
  }
  return drafted;
}

std::vector<Foresight> ToolSurvey::Foresights() const {
  std::vector<Foresight> result;
  for (const Event& event : foresights_) {
    Foresight foresight{event.run, event.value_rad, event.sigma_rad, std::nullopt, 0};
    for (const RunState& run : runs_) {
      if (run.survey->summary().run != event.run || !run.survey->filter()) continue;
      const auto& epochs = run.survey->filter()->history().epochs;
      if (epochs.empty()) continue;
      auto at = std::lower_bound(
          epochs.begin(), epochs.end(), event.utc,
          [](const FilterEpoch& epoch, UtcTime utc) { return epoch.knot.utc < utc; });
      const bool after = at == epochs.end();
      if (after) --at;
      const auto i = static_cast<std::size_t>(at - epochs.begin());
      if (i >= run.attitude.size()) continue;
      const double away = std::abs((at->knot.utc - event.utc).seconds());
      const AlongHole& along = at->knot.along;
      const bool rests = at->knot.still || (along.known && std::abs(along.speed) <= kHeldSpeed);
      const bool held = after && rests && away <= kHeld.seconds();
      if (away > kForesightSeconds && !held) continue;
      const AttitudeSample& attitude = run.attitude[i];
      if (!attitude.azimuth_known) continue;
      foresight.measured = DirectionOfMark(attitude);
      foresight.sigma_measured = std::sqrt(attitude.cov_attitude(1, 1));
    }
    result.push_back(foresight);
  }
  return result;
}

std::vector<Check> ToolSurvey::Checks(const std::vector<Station>& passes) const {
  std::vector<RunSummary> summaries;
  for (const RunState& run : runs_) summaries.push_back(run.survey->summary());
  const std::vector<Foresight> foresights = Foresights();
  return MakeChecks(job_, {summaries, passes, foresights, returns_, &marks_});
}

/// Stations that were asked for and passed, but at which no azimuth is known.
std::int64_t ToolSurvey::WithoutAzimuth() const {
  std::int64_t count = 0;
  for (const RunState& run : runs_) {
    const AzimuthFilter* filter = run.survey->filter();
    for (const Draft& draft : run.survey->drafts()) {
      if (!draft.listed || !draft.state || !filter) continue;
      const std::size_t i = *draft.state;
      const StationState& state = i < run.adjusted.size() ? run.adjusted[i] : filter->stations()[i];
      count += HasDirection(state.attitude) ? 0 : 1;
    }
  }
  return count;
}

Check ToolSurvey::CheckAzimuths() const {
  Check check;
  check.code = "stations_without_azimuth";
  const auto count = static_cast<double>(WithoutAzimuth());
  check.value = count;
  check.sigma = check.limit = 0;
  check.unit = "1";
  check.limit_source = "every station passed has an azimuth";
  check.verdict = Judge(count, 0);
  return check;
}

Survey ToolSurvey::Current() const {
  Survey survey;
  for (const RunState& run : runs_) {
    survey.runs.push_back(run.survey->summary());
    RunSummary& summary = survey.runs.back();
    summary.misrun = book_.misrun(summary.run);
    summary.remark = book_.remark(summary.run);
    summary.duplicates = queue_.counts().duplicates;
  }
  if (runs_.empty()) {
    survey.unusable = "no samples came, and no averages at rest";
    return survey;
  }
  const std::vector<DraftedRun> drafted = Drafted();
  Placed placed = Assemble(job_, drafted);
  survey.checks = Checks(placed.passes);
  survey.checks.push_back(CheckAzimuths());
  if (!job_.stations.at.empty()) survey.checks.push_back(CheckAsked(job_, placed.chosen));
  survey.passes = std::move(placed.passes);
  survey.chosen = std::move(placed.chosen);
  survey.unusable = std::move(placed.unusable);
  if (survey.unusable.empty()) survey.unusable = TakeModelCovariance(job_, survey.chosen);
  survey.accepted = std::any_of(survey.passes.begin(), survey.passes.end(), [](const Station& s) {
    return s.status == StationStatus::kDefinitive;
  });
  const bool north = std::any_of(drafted.begin(), drafted.end(), [](const DraftedRun& run) {
    return std::any_of(run.drafts.begin(), run.drafts.end(), [&run](const Draft& draft) {
      return !draft.state || run.states[*draft.state].attitude.azimuth_known;
    });
  });
  const bool depth = std::any_of(runs_.begin(), runs_.end(), [](const RunState& run) {
    return run.survey->depth_seen() || run.survey->summary().samples == 0;
  });
  if (!depth) {
    survey.unusable = fmt::format(
        "samples came but no depth with them: no marks on {} at their times, or all further apart "
        "than [depth] max_gap_s = {}",
        job_.channels.depth, job_.depth.max_gap);
  } else if (!north && (survey.chosen.empty() || WithoutAzimuth() > 0)) {
    survey.unusable = job_.alignment.method == AlignmentSpec::Method::kExternal
                          ? "no north was found: the depth or time at which the job's external "
                            "azimuth holds was never reached"
                          : fmt::format(
                                "no north was found: no stop of {:.0f} s at which the gyros tell "
                                "one azimuth from its mirror, and the job gives no azimuth; log a "
                                "stop, or use [alignment] method = \"external\"",
                                job_.alignment.min_still);
  }
  if (!survey.unusable.empty()) survey.chosen.clear();
  return survey;
}

}  // namespace wellgyro
