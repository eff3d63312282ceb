#include "wellgyro/survey/surveyor.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/time_range.h"
#include "wellgyro/calibration/apply.h"
#include "wellgyro/depth/cable.h"
#include "wellgyro/depth/depth_track.h"
#include "wellgyro/survey/run_book.h"
#include "wellgyro/survey/tool_survey.h"

namespace wellgyro {
namespace {

// A depth mark with a time so far ahead of the samples would make all others late.
constexpr Duration kAhead = Duration::Seconds(600);
// Of data time, between looks at which depth marks are still needed.
constexpr Duration kForgetEvery = Duration::Seconds(16);

const Job& Checked(const Job& job) {
  CheckJob(job);
  return job;
}

DepthTrackSetup TrackSetup(const Job& job) {
  DepthTrackSetup setup;
  setup.latency = std::max(Duration::Seconds(job.depth.latency), Duration::Seconds(0.001));
  setup.max_gap = Duration::Seconds(job.depth.max_gap);
  setup.sigma_md = job.errors.depth_sigma;
  return setup;
}

}  // namespace

Sink::~Sink() = default;
RunAdjuster::~RunAdjuster() = default;

struct Surveyor::Rooms {
  Rooms(const Job& the_job, Sink& the_sink, const RunAdjuster* the_adjuster)
      : job(Checked(the_job)),
        sink(the_sink),
        adjuster(the_adjuster),
        track(TrackSetup(job)),
        marks(job.depth.cable, track),
        book(job.runs) {
    for (const Event& event : job.events) Take(event);
  }

  Job job;
  Sink& sink;
  const RunAdjuster* adjuster;
  DepthTrack track;
  MarksRefused refused;
  CableMarks marks;
  RunBook book;
  std::map<std::int32_t, ToolSurvey> tools;
  std::vector<Operation> operations;  ///< all so far, for a tool that is heard of later
  std::vector<ToolInfo> infos;
  std::map<std::int32_t, SampleCalibrator> calibrators;  ///< of each tool
  std::vector<ImuSample> calibrated;                     ///< scratch
  std::int64_t forgotten_at = 0;                         ///< in kForgetEvery
  bool finished = false;
  std::optional<UtcTime> newest;  ///< begin of the last sample that came

  /// nullptr: one tool too many.
  ToolSurvey* Tool(std::int32_t number) {
    const auto found = tools.find(number);
    if (found != tools.end()) return &found->second;
    if (tools.size() >= kToolsMax) {
      sink.OnFault(Fault{FaultCode::kRange, fmt::format("tool {} is one more than {}: its messages "
                                                        "are left out",
                                                        number, kToolsMax)});
      return nullptr;
    }
    ToolSurvey& tool =
        tools.try_emplace(number, job, number, track, refused, marks, book, sink, adjuster)
            .first->second;
    for (const ToolInfo& info : infos) {
      if (info.tool == number) tool.Push(info);
    }
    for (const Operation& operation : operations) tool.Push(operation);
    return &tool;
  }

  void Take(const Operation& operation) {
    if (operations.size() >= kOperationsMax) {
      sink.OnFault(Fault{FaultCode::kRange, fmt::format("one command, mode or event more than {}: "
                                                        "it is left out",
                                                        kOperationsMax)});
      return;
    }
    if (const auto* event = std::get_if<Event>(&operation)) {
      if (const auto fault = track.Push(*event)) sink.OnFault(*fault);
      book.Take(*event);
    }
    operations.push_back(operation);
    for (auto& [number, tool] : tools) tool.Push(operation);
  }

  bool Open() {
    if (finished) {
      sink.OnFault(Fault{FaultCode::kOrder, "a message came after the survey was finished"});
    }
    return !finished;
  }

  /// After samples of `tool`.
  void Work(const ToolSurvey& tool) {
    if (tool.finish_asked()) {
      Finish();
      return;
    }
    // Looking through all tools at every batch would make a hundred of them cost their square.
    const std::int64_t period = tool.Needs().ns / kForgetEvery.ns;
    if (period == forgotten_at) return;
    forgotten_at = period;
    UtcTime needed = tool.Needs();
    for (const auto& [number, other] : tools) needed = std::min(needed, other.Needs());
    track.Forget(needed - track.lag() - DepthGrid::kStep);
  }

  void Finish() {
    if (finished) return;
    finished = true;
    std::optional<UtcTime> until;
    for (auto& [number, tool] : tools) {
      const auto asked = tool.finish_asked_at();
      if (asked && (!until || *asked < *until)) until = asked;
    }
    for (auto& [number, tool] : tools) tool.Finish(until);
  }
};

Surveyor::Surveyor(const Job& job, Sink& sink, const RunAdjuster* adjuster)
    : rooms_(std::make_unique<Rooms>(job, sink, adjuster)) {}
Surveyor::~Surveyor() = default;
Surveyor::Surveyor(Surveyor&&) noexcept = default;
Surveyor& Surveyor::operator=(Surveyor&&) noexcept = default;

void Surveyor::Push(std::span<const ImuSample> batch) {
  if (!rooms_->Open()) return;
  for (auto at = batch.begin(); at != batch.end() && !rooms_->finished;) {
    ToolSurvey* tool = rooms_->Tool(at->stamp.tool);
    if (tool == nullptr) return;
    const auto end = std::find_if(at, batch.end(), [tool](const ImuSample& sample) {
      return sample.stamp.tool != tool->tool();
    });
    tool->Push(std::span(at, end));
    const UtcTime last = std::prev(end)->stamp.utc;
    if (IsWithinReach(last)) rooms_->newest = last;
    rooms_->Work(*tool);
    at = end;
  }
}

void Surveyor::Push(std::span<const RawSample> batch) {
  if (!rooms_->Open() || batch.empty()) return;
  if (!rooms_->job.tool) {
    rooms_->sink.OnFault(Fault{FaultCode::kConflict,
                               "counts came, but the job does not say what they mean: give [tool] "
                               "file"});
    return;
  }
  const std::int32_t tool = batch.front().stamp.tool;
  SampleCalibrator& calibrator =
      rooms_->calibrators.try_emplace(tool, *rooms_->job.tool).first->second;
  std::vector<ImuSample>& samples = rooms_->calibrated;
  if (samples.size() < batch.size()) samples.resize(batch.size());
  const std::size_t done = calibrator.Apply(batch, samples);
  if (done < batch.size()) {
    rooms_->sink.OnFault(Fault{FaultCode::kConflict, calibrator.WhyNot(batch[done])});
  }
  Push(std::span<const ImuSample>(samples.data(), done));
}

void Surveyor::Push(const ImuSample& sample) { Push({&sample, 1}); }

void Surveyor::Push(const StillWindow& window) {
  if (!rooms_->Open()) return;
  if (ToolSurvey* tool = rooms_->Tool(window.tool)) tool->Push(window);
}

void Surveyor::Push(const DepthMark& mark) {
  if (!rooms_->Open()) return;
  const bool dated = rooms_->newest && IsWithinReach(mark.utc);
  if (dated && mark.utc - *rooms_->newest > kAhead) {
    ++rooms_->refused.impossible;
    rooms_->sink.OnFault(Fault{FaultCode::kRange,
                               fmt::format("a depth mark is stamped {:.0f} s ahead of the samples "
                                           "and was left out",
                                           (mark.utc - *rooms_->newest).seconds())});
    return;
  }
  DepthMark told = mark;
  if (!told.sigma) told.sigma = rooms_->job.errors.depth_sigma;
  told = Stretched(rooms_->job.depth.cable, told);
  if (const auto fault = rooms_->track.Push(told)) {
    ++(fault->code == FaultCode::kLate ? rooms_->refused.late : rooms_->refused.impossible);
    rooms_->sink.OnFault(*fault);
  } else {
    rooms_->marks.Push(told);
  }
}

void Surveyor::Push(const ToolMode& mode) {
  if (rooms_->Open()) rooms_->Take(mode);
}

void Surveyor::Push(const ToolInfo& info) {
  if (!rooms_->Open()) return;
  if (rooms_->infos.size() < kOperationsMax) rooms_->infos.push_back(info);
  const auto tool = rooms_->tools.find(info.tool);
  if (tool != rooms_->tools.end()) tool->second.Push(info);
}

void Surveyor::Push(const Command& command) {
  if (rooms_->Open()) rooms_->Take(command);
}

void Surveyor::Push(const Event& event) {
  if (rooms_->Open()) rooms_->Take(event);
}

void Surveyor::Adjust() {
  for (auto& [number, tool] : rooms_->tools) tool.Adjust();
}

void Surveyor::Finish() { rooms_->Finish(); }

bool Surveyor::finished() const { return rooms_->finished; }

SampleTally Surveyor::tally() const {
  SampleTally sum;
  for (const auto& [number, tool] : rooms_->tools) {
    const SampleTally one = tool.tally();
    sum.received += one.received;
    sum.lost += one.lost;
    sum.gaps += one.gaps;
    sum.duplicates += one.duplicates;
    if (one.newest && (!sum.newest || *sum.newest < *one.newest)) sum.newest = one.newest;
  }
  return sum;
}

std::vector<std::int32_t> Surveyor::tools() const {
  std::vector<std::int32_t> numbers;
  for (const auto& [number, tool] : rooms_->tools) numbers.push_back(number);
  return numbers;
}

Survey Surveyor::Current(std::int32_t tool) const {
  const auto found = rooms_->tools.find(tool);
  if (found != rooms_->tools.end()) return found->second.Current();
  Survey none;
  none.unusable = "no samples came, and no averages at rest";
  return none;
}

}  // namespace wellgyro
