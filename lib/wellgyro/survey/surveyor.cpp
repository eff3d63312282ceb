#include "wellgyro/survey/surveyor.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/time_range.h"
#include "wellgyro/calibration/apply.h"
#include "wellgyro/depth/cable.h"
#include "wellgyro/depth/depth_track.h"
#include "wellgyro/record/limits.h"
#include "wellgyro/survey/intake/mark_gate.h"
#include "wellgyro/survey/intake/plausible.h"
#include "wellgyro/survey/run/run_book.h"
#include "wellgyro/survey/run/run_now.h"
#include "wellgyro/survey/tool_survey.h"

namespace wellgyro {
namespace {

// Marks are ahead of the samples by the depth's latency, or by what a message holds of these.
constexpr Duration kAheadAtLeast = Duration::Seconds(1);
// Of a batch, samples of no longer a time are used before the marks up to their end are: half of
// kAheadAtLeast, so that these are not ahead.
constexpr Duration kBatchPart = Duration::Seconds(0.5);
// A tool of so many samples, a full message, is there and gives way to none that is new.
constexpr std::int64_t kEstablished = limits::kBatch;
// What tools say of themselves may come before any of their samples: room for four times as many.
constexpr std::size_t kInfosMax = 4 * Surveyor::kToolsMax;
// Of data time, between looks at which depth marks are still needed: 160 marks of 10 Hz more.
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

bool IsInPart(UtcTime begin, UtcTime utc) {
  return IsWithinReach(begin) && IsWithinReach(utc) && utc - begin <= kBatchPart;
}

}  // namespace

Sink::~Sink() = default;
RunAdjuster::~RunAdjuster() = default;

struct Surveyor::Rooms {
  Rooms(const Job& the_job, Sink& the_sink)
      : job(Checked(the_job)),
        sink(the_sink),
        track(TrackSetup(job)),
        marks(job.depth.cable, track),
        gate(
            std::max(Duration::Seconds(job.depth.latency), kAheadAtLeast),
            Duration::Seconds(job.depth.max_gap), [this](const DepthMark& mark) { Use(mark); },
            [this](const Fault& fault) {
              ++refused.impossible;
              sink.OnFault(fault);
            }),
        book(job.runs) {
    for (const Event& event : job.events) Take(event);
  }

  Job job;
  Sink& sink;
  const RunAdjuster* adjuster = nullptr;
  DepthTrack track;
  MarksRefused refused;
  CableMarks marks;
  MarkGate gate;
  RunBook book;
  std::map<std::int32_t, ToolSurvey> tools;
  // For a tool that is heard of later: all commands and events so far, and the last modes.
  std::vector<Operation> operations;
  std::deque<ToolMode> modes;
  std::map<std::int32_t, ToolInfo> infos;                ///< the latest of each tool
  std::map<std::int32_t, SampleCalibrator> calibrators;  ///< of each tool
  std::vector<ImuSample> calibrated;                     ///< scratch
  std::int64_t forgotten_at = 0;                         ///< in kForgetEvery
  bool finished = false, flushed = false;
  double sigma_utc = 0;         ///< see TieClock [s]
  std::int64_t most_heard = 0;  ///< samples of the tool that has most: its clock is the string's

  /// Those of numbers that no tool has, as of damaged messages, are forgotten again.
  SampleCalibrator& Calibrator(std::int32_t tool_number) {
    if (calibrators.size() > 2 * kToolsMax) {
      std::erase_if(calibrators, [this](const auto& of) { return !tools.contains(of.first); });
    }
    return calibrators.try_emplace(tool_number, *job.tool).first->second;
  }

  /// nullptr: one tool too many.
  ToolSurvey* Tool(std::int32_t number) {
    const auto found = tools.find(number);
    if (found != tools.end()) return &found->second;
    if (tools.size() >= kToolsMax && !GiveWay(number)) return nullptr;
    ToolSurvey& tool =
        tools
            .try_emplace(number, job, number, StringRecords{track, refused, marks, book, sigma_utc},
                         sink, adjuster)
            .first->second;
    const auto info = infos.find(number);
    if (info != infos.end()) tool.Push(info->second);
    for (const Operation& operation : operations) tool.Push(operation);
    for (const ToolMode& mode : modes) tool.Push(mode);
    return &tool;
  }

  /// Leaves out the tool of which least has come, for one that is new; or the new one.
  bool GiveWay(std::int32_t number) {
    const auto least = std::min_element(tools.begin(), tools.end(), [](auto& a, auto& b) {
      return a.second.tally().received < b.second.tally().received;
    });
    const std::int64_t samples = least->second.tally().received;
    const bool gives_way = samples < kEstablished;
    sink.OnFault(Fault{FaultCode::kRange,
                       fmt::format("tool {} is one more than {}: {}", number, kToolsMax,
                                   gives_way ? fmt::format("tool {} with {} samples is left out",
                                                           least->first, samples)
                                             : "its messages are left out")});
    if (gives_way) tools.erase(least);
    return gives_way;
  }

  void Take(const Operation& operation) {
    const auto* mode = std::get_if<ToolMode>(&operation);
    if (mode != nullptr) {
      modes.push_back(*mode);
      if (modes.size() > kModesKept) modes.pop_front();
    } else if (operations.size() >= kOperationsMax) {
      sink.OnFault(Fault{FaultCode::kRange, fmt::format("one command or event more than {}: it is "
                                                        "left out",
                                                        kOperationsMax)});
      return;
    } else {
      operations.push_back(operation);
    }
    if (const auto* event = std::get_if<Event>(&operation)) {
      if (const auto fault = track.Push(*event)) sink.OnFault(*fault);
      book.Take(*event);
    }
    for (auto& [number, tool] : tools) tool.Push(operation);
  }

  /// Whether the survey is open and `record` holds what it can hold; otherwise a Fault.
  template <class Record>
  bool Admits(const Record& record) {
    if (!Open()) return false;
    const std::string why = WhyImplausible(record);
    if (!why.empty()) sink.OnFault(Fault{FaultCode::kRange, why});
    return why.empty();
  }

  void Use(const DepthMark& mark) {
    if (const auto fault = track.Push(mark)) {
      ++(fault->code == FaultCode::kLate ? refused.late : refused.impossible);
      sink.OnFault(*fault);
    } else {
      marks.Push(mark);
    }
  }

  /// Samples of one tool, with the depth marks that waited for them.
  void Use(ToolSurvey& tool, std::span<const ImuSample> samples) {
    while (!samples.empty() && !finished) {
      const UtcTime begin = samples.front().stamp.utc;
      const auto end = std::ranges::find_if_not(
          samples, [begin](const ImuSample& s) { return IsInPart(begin, s.stamp.utc); });
      const auto count = std::max<std::ptrdiff_t>(end - samples.begin(), 1);
      const auto part = samples.first(static_cast<std::size_t>(count));
      for (auto rest = part; !rest.empty();) {
        rest = tool.Take(rest);
        Hear(tool);
        tool.Work();
      }
      Work(tool);
      samples = samples.subspan(part.size());
    }
  }

  void Hear(const ToolSurvey& tool) {
    const SampleTally tally = tool.tally();
    if (!tally.newest || tally.received < most_heard) return;
    most_heard = tally.received;
    gate.HeardAt(*tally.newest);
  }

  bool Open() {
    const bool open = !finished && !flushed;
    if (!open) {
      sink.OnFault(Fault{FaultCode::kOrder, "a message came after the survey was finished"});
    }
    return open;
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
    if (const auto begin = tool.begin()) track.NeedFrom(*begin);
    UtcTime needed = tool.Needs();
    for (const auto& [number, other] : tools) needed = std::min(needed, other.Needs());
    track.Forget(needed - track.reach() - track.latency() - DepthGrid::kStep);
  }

  void Finish() {
    if (finished) return;
    finished = true;
    gate.Close();
    std::optional<UtcTime> until;
    for (auto& [number, tool] : tools) {
      const auto asked = tool.finish_asked_at();
      if (asked && (!until || *asked < *until)) until = asked;
    }
    for (auto& [number, tool] : tools) tool.Finish(until);
  }
};

void AdjustBy(const RunAdjuster& adjuster, Surveyor& surveyor) {
  surveyor.rooms_->adjuster = &adjuster;
}

Surveyor::Surveyor(const Job& job, Sink& sink) : rooms_(std::make_unique<Rooms>(job, sink)) {}
Surveyor::~Surveyor() = default;
Surveyor::Surveyor(Surveyor&&) noexcept = default;
Surveyor& Surveyor::operator=(Surveyor&&) noexcept = default;

void Surveyor::Push(std::span<const ImuSample> batch) {
  if (!rooms_->Open()) return;
  std::optional<std::int32_t> refused;  // told once a batch, however the tools' samples interleave
  for (auto at = batch.begin(); at != batch.end() && !rooms_->finished;) {
    const std::int32_t number = at->stamp.tool;
    const auto end = std::find_if(
        at, batch.end(), [number](const ImuSample& sample) { return sample.stamp.tool != number; });
    ToolSurvey* tool = number == refused ? nullptr : rooms_->Tool(number);
    if (tool != nullptr) {
      rooms_->Use(*tool, std::span(at, end));
    } else {
      refused = number;
    }
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
  std::vector<ImuSample>& samples = rooms_->calibrated;
  if (samples.size() < batch.size()) samples.resize(batch.size());
  const RawSample* misfit = nullptr;
  for (std::span<const RawSample> rest = batch; !rest.empty();) {
    const std::int32_t tool = rest.front().stamp.tool;
    const auto other = std::find_if(rest.begin(), rest.end(), [tool](const RawSample& sample) {
      return sample.stamp.tool != tool;
    });
    const auto of_tool = rest.first(static_cast<std::size_t>(other - rest.begin()));
    SampleCalibrator& calibrator = rooms_->Calibrator(tool);
    const std::size_t done = calibrator.Apply(of_tool, samples);
    Push(std::span<const ImuSample>(samples.data(), done));
    const bool fit = done == of_tool.size();
    if (!fit && misfit == nullptr) {
      misfit = &of_tool[done];
      rooms_->sink.OnFault(Fault{FaultCode::kConflict, calibrator.WhyNot(*misfit)});
    }
    rest = rest.subspan(fit ? done : done + 1);
  }
}

void Surveyor::Push(const ImuSample& sample) { Push({&sample, 1}); }

void Surveyor::Push(const StillWindow& window) {
  if (!rooms_->Open()) return;
  rooms_->gate.Open();
  if (ToolSurvey* tool = rooms_->Tool(window.tool)) tool->Push(window);
}

void Surveyor::Push(const DepthMark& mark) {
  if (!rooms_->Open()) return;
  if (std::string why = WhyImplausible(mark); !why.empty()) {
    ++rooms_->refused.impossible;
    rooms_->sink.OnFault(Fault{FaultCode::kRange, std::move(why)});
    return;
  }
  DepthMark told = mark;
  if (!told.sigma) told.sigma = rooms_->job.errors.depth_sigma;
  rooms_->gate.Push(Stretched(rooms_->job.depth.cable, told));
}

void Surveyor::Push(const ToolMode& mode) {
  if (rooms_->Open()) rooms_->Take(mode);
}

void Surveyor::Push(const ToolInfo& info) {
  if (!rooms_->Admits(info)) return;
  auto& infos = rooms_->infos;
  if (infos.size() >= kInfosMax && !infos.contains(info.tool)) {
    // One of a tool that has sent nothing else makes room.
    std::erase_if(infos, [this](const auto& i) { return !rooms_->tools.contains(i.first); });
  }
  infos.insert_or_assign(info.tool, info);
  const auto tool = rooms_->tools.find(info.tool);
  if (tool != rooms_->tools.end()) tool->second.Push(info);
}

void Surveyor::Push(const Command& command) {
  if (rooms_->Admits(command)) rooms_->Take(command);
}

void Surveyor::Push(const Event& event) {
  if (rooms_->Admits(event)) rooms_->Take(event);
}

void Surveyor::TieClock(double sigma_utc) {
  if (!(sigma_utc >= 0 && std::isfinite(sigma_utc))) {
    throw std::invalid_argument(fmt::format("sigma_utc = {} must be at least 0", sigma_utc));
  }
  rooms_->sigma_utc = sigma_utc;
}

void Surveyor::Adjust() {
  for (auto& [number, tool] : rooms_->tools) tool.Adjust();
}

void Surveyor::Flush() {
  if (rooms_->finished || std::exchange(rooms_->flushed, true)) return;
  rooms_->gate.Close();
  for (auto& [number, tool] : rooms_->tools) tool.Flush(std::nullopt);
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

RunNow Surveyor::Now(std::int32_t tool) const {
  const auto found = rooms_->tools.find(tool);
  return found == rooms_->tools.end() ? RunNow() : found->second.Now();
}

Survey Surveyor::Current(std::int32_t tool) const {
  const auto found = rooms_->tools.find(tool);
  if (found != rooms_->tools.end()) return found->second.Current();
  Survey none;
  none.unusable = "no samples came, and no averages at rest";
  return none;
}

}  // namespace wellgyro
