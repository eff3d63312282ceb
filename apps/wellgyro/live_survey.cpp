#include "live_survey.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/bus/latency.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/bus/log_writer.h"
#include "wellgyro/bus/loss_watch.h"
#include "wellgyro/fit/run_adjustment.h"
#include "wellgyro/survey/surveyor.h"

#include "broadcast.h"
#include "catch_up.h"
#include "commands.h"
#include "delivery.h"
#include "intake.h"
#include "journal.h"
#include "live.h"
#include "report.h"
#include "result_keeper.h"

namespace wellgyro::apps {
namespace {

constexpr std::int64_t kSecondUs = 1'000'000;
constexpr std::int64_t kKeepUs = 500'000;
// A FINISH that no sample reaches, because the tool is off, holds after so long without samples.
constexpr std::int64_t kFinishPatienceUs = 5 * kSecondUs;
// Snapshots take at most this share of the stream's thread, so that few stations wait for one.
constexpr std::int64_t kSnapshotShare = 200;
// What is still used of a backlog when a signal comes.
constexpr std::int64_t kDrainUs = 20'000;

enum class Ended { kFinished, kInterrupted, kBusGone };

class LiveSurvey {
 public:
  LiveSurvey(const SurveyOptions& options, const JobFile& job, LiveBus& bus)
      : options_(options),
        job_(job),
        bus_(bus),
        broadcast_(bus, job.job.channels),
        surveyor_(job.job, broadcast_, InAngles(job.job) ? &adjuster_ : nullptr),
        intake_(job.job, surveyor_),
        watch_([this](const Fault& fault) { losses_.Tell(fault); }),
        catch_up_(job.job.channels,
                  [this](auto channel, auto bytes, auto received_us, bool fresh) {
                    Use(channel, bytes, received_us, fresh);
                  }),
        keeper_(job.job) {
    intake_.Watch(watch_);
  }

  std::optional<Fault> Begin();
  Ended Run();
  int End(Ended ended);

 private:
  void Hear(std::string_view channel, std::span<const std::byte> bytes, std::int64_t received_us);
  void Use(std::string_view channel, std::span<const std::byte> bytes, std::int64_t received_us,
           bool record);
  void Record(std::string_view channel, std::span<const std::byte> bytes, std::int64_t received_us);
  std::optional<Fault> BeginRecord();
  Result<bool> Resume();
  void Housekeeping();
  void SendStatus(std::int64_t now);
  void KeepFiles(std::int64_t now);
  bool FinishIsDue(std::int64_t now);
  Snapshot Take() const;
  SourceRecord Source() const;

  const SurveyOptions& options_;
  const JobFile& job_;
  LiveBus& bus_;
  FaultTeller losses_;
  Broadcast broadcast_;
  LeastSquaresAdjuster adjuster_;
  Surveyor surveyor_;
  Intake intake_;
  LossWatch watch_;
  CatchUp catch_up_;
  ResultKeeper keeper_;
  std::optional<LogWriter> log_;
  bool record_failed_ = false, record_moved_ = false;
  bool resuming_ = false;
  Latency message_latency_, station_latency_;
  std::int64_t next_status_ = 0, next_keep_ = 0;
  std::int64_t kept_news_ = 0;
  std::int64_t sample_messages_ = 0, last_sample_us_ = 0;
  std::int64_t kernel_drops_said_ = 0;
};

std::optional<Fault> LiveSurvey::Begin() {
  resuming_ = options_.resume;
  // Heard from now on, so that nothing falls between the logs and the stream.
  std::vector<std::string> channels;
  for (const MessageType type :
       {MessageType::kRawBatch, MessageType::kImuBatch, MessageType::kStillWindow,
        MessageType::kDepth, MessageType::kToolMode, MessageType::kToolInfo, MessageType::kEvent,
        MessageType::kCommand}) {
    channels.push_back(NameOf(job_.job.channels, type));
  }
  if (auto fault = bus_.Subscribe(channels, [this](auto channel, auto bytes, auto received_us) {
        Hear(channel, bytes, received_us);
      })) {
    return fault;
  }
  return options_.record.empty() ? std::nullopt : BeginRecord();
}

/// The journal before the log: where there is a log there is what it takes to continue it.
std::optional<Fault> LiveSurvey::BeginRecord() {
  Journal journal = JournalOf(job_, options_.record, resuming_ ? 0 : NowUs());
  if (resuming_) {
    const Result<Journal> left = ReadJournal(options_.out, journal);
    if (!left) return left.fault();
    journal = *left;
    RemovePartials(options_.out);
    broadcast_.Mute(true);
    if (auto fault = catch_up_.OwnLog(options_.record, journal.begun_us)) return fault;
  } else if (std::filesystem::exists(options_.record)) {
    return Fault{FaultCode::kConflict,
                 "exists already: --resume continues it, or give another name", options_.record};
  }
  if (auto fault = WriteJournal(options_.out, journal)) return fault;
  auto log = LogWriter::Open(options_.record, resuming_ ? IfExists::kAppend : IfExists::kRefuse);
  if (!log) return log.fault();
  log_.emplace(std::move(*log));
  return std::nullopt;
}

void LiveSurvey::Hear(std::string_view channel, std::span<const std::byte> bytes,
                      std::int64_t received_us) {
  if (resuming_) {
    catch_up_.Hold(channel, bytes, received_us);
  } else {
    Use(channel, bytes, received_us, true);
  }
}

void LiveSurvey::Record(std::string_view channel, std::span<const std::byte> bytes,
                        std::int64_t received_us) {
  if (!log_ || record_failed_) return;
  auto fault = log_->Write(channel, bytes, received_us);
  if (!fault) fault = log_->Flush();
  if (!fault) return;
  record_failed_ = true;
  Complain(*fault);
  Complain("the survey goes on without recording; it cannot be resumed beyond this");
}

void LiveSurvey::Use(std::string_view channel, std::span<const std::byte> bytes,
                     std::int64_t received_us, bool record) {
  // What comes after FINISH is no part of the survey, nor of its log.
  if (surveyor_.finished()) return;
  // Written before it is used: whatever has left this program can be made again.
  if (record) Record(channel, bytes, received_us);
  const std::int64_t stations = broadcast_.stations();
  intake_.Take(channel, bytes);
  if (resuming_) return;
  const std::int64_t now = NowUs();
  message_latency_.Add(now - received_us);
  if (broadcast_.stations() > stations) station_latency_.Add(now - received_us);
}

Result<bool> LiveSurvey::Resume() {
  auto stopped = catch_up_.FillAndJoin(bus_, options_.fill);
  resuming_ = false;
  broadcast_.Mute(false);
  if (!stopped) return stopped;
  for (const std::int32_t tool : surveyor_.tools()) {
    for (const Station& station : surveyor_.Current(tool).passes) broadcast_.OnStation(station);
  }
  fmt::print(stderr, "resumed after {} samples\n", surveyor_.tally().received);
  return stopped;
}

Ended LiveSurvey::Run() {
  if (resuming_) {
    const auto stopped = Resume();
    if (!stopped) {
      Complain(stopped.fault());
      return Ended::kBusGone;
    }
    if (*stopped) return Ended::kInterrupted;
  }
  next_status_ = MonotonicUs();
  for (;;) {
    Housekeeping();
    if (surveyor_.finished()) return Ended::kFinished;
    const std::int64_t wait = std::max<std::int64_t>(next_status_ - MonotonicUs(), 0) / 1000 + 1;
    const auto woken = bus_.Wait(static_cast<int>(std::min<std::int64_t>(wait, 100)));
    if (!woken) {
      Complain(woken.fault());
      return Ended::kBusGone;
    }
    if (*woken != LiveBus::Woken::kStopped) continue;
    DrainStopped(bus_, 0, kDrainUs);
    return surveyor_.finished() ? Ended::kFinished : Ended::kInterrupted;
  }
}

void LiveSurvey::Housekeeping() {
  const std::int64_t now = MonotonicUs();
  if (FinishIsDue(now)) surveyor_.Finish();
  if (now >= next_status_ || broadcast_.must_acknowledge()) SendStatus(now);
  if (now >= next_keep_) KeepFiles(now);
}

bool LiveSurvey::FinishIsDue(std::int64_t now) {
  const std::int64_t messages = intake_.sample_messages();
  if (messages != sample_messages_ || last_sample_us_ == 0) {
    sample_messages_ = messages;
    last_sample_us_ = now;
  }
  return intake_.finish_heard() && now - last_sample_us_ > kFinishPatienceUs;
}

void LiveSurvey::SendStatus(std::int64_t now) {
  const bool on_time = now >= next_status_;
  if (on_time) next_status_ = std::max(next_status_ + kSecondUs, now);
  const SampleTally tally = surveyor_.tally();
  Status status;
  status.samples_received = tally.received;
  status.samples_lost = tally.lost;
  status.gaps = tally.gaps;
  status.duplicates = tally.duplicates;
  status.malformed = intake_.feed().malformed() + bus_.refused();
  status.kernel_drops = bus_.kernel_drops();
  status.latency_p99 = static_cast<double>(message_latency_.Recent(on_time)) * 1e-6;
  if (tally.newest) {
    status.data_age = (UtcTime{NowUs() * 1000} - *tally.newest).seconds();
  }
  const std::int64_t drops = status.kernel_drops.value_or(0);
  if (drops > kernel_drops_said_) {
    Complain(
        fmt::format("the system has thrown away {} datagrams: its receive buffer was full", drops));
    kernel_drops_said_ = drops;
  }
  if (on_time && log_ && !record_moved_ && !log_->InPlace()) {
    record_moved_ = true;
    Complain(
        fmt::format("{} was moved or removed: recording goes on in it, and --resume needs it back "
                    "under that name",
                    options_.record));
  }
  if (tally.lost > 0) status.text = "samples were lost";
  if (drops > 0) status.text = "the receive buffer overflowed";
  if (keeper_.failing()) status.text = "the survey's files cannot be written";
  if (record_moved_) status.text = "the recording was moved or removed";
  if (record_failed_) status.text = "the recording has stopped";
  if (!status.text.empty()) status.state = Status::State::kDegraded;
  if (record_failed_ || keeper_.failing()) status.state = Status::State::kFault;
  broadcast_.Send(std::move(status));
}

void LiveSurvey::KeepFiles(std::int64_t now) {
  next_keep_ = now + kKeepUs;
  if (broadcast_.news() == kept_news_ || !keeper_.idle()) return;
  kept_news_ = broadcast_.news();
  keeper_.Keep(Take());
  const std::int64_t cost = MonotonicUs() - now;
  next_keep_ = now + std::max(kKeepUs, kSnapshotShare * cost);
}

SourceRecord LiveSurvey::Source() const {
  SourceRecord source;
  source.name = bus_.url();
  source.faults = intake_.faults().faults();
  source.counts["malformed"] = intake_.feed().malformed();
  source.counts["refused_by_size"] = bus_.refused();
  if (const auto drops = bus_.kernel_drops()) source.counts["kernel_drops"] = *drops;
  if (const auto granted = bus_.granted_receive_buffer()) {
    source.counts["receive_buffer_bytes"] = *granted;
  }
  source.counts["station_latency_median_us"] = station_latency_.Of(0.5);
  source.counts["station_latency_p99_us"] = station_latency_.Of(0.99);
  source.counts["message_latency_p99_us"] = message_latency_.Of(0.99);
  return source;
}

Snapshot LiveSurvey::Take() const {
  Snapshot snapshot;
  snapshot.folder = options_.out;
  snapshot.tools = ResultsOf(surveyor_, options_.out);
  snapshot.record = RecordOf(job_, options_.formats, intake_, broadcast_);
  snapshot.source = Source();
  snapshot.source.ended = "not yet";
  return snapshot;
}

int LiveSurvey::End(Ended ended) {
  if (ended == Ended::kFinished) {
    watch_.Settle();
    SendStatus(next_status_);
    keeper_.End();
    SourceRecord source = Source();
    source.ended = "adjusted";
    HintAtChannels(intake_.feed());
    return DeliverAll(options_.out, job_, surveyor_,
                      RecordOf(job_, options_.formats, intake_, broadcast_), source);
  }
  Snapshot snapshot = Take();
  snapshot.source.ended = ended == Ended::kInterrupted ? "interrupted" : "the bus was lost";
  keeper_.End();
  const auto fault = ResultKeeper::Write(job_.job, snapshot);
  if (fault) Complain(*fault);
  if (log_) static_cast<void>(log_->Close());
  const bool any = std::any_of(snapshot.tools.begin(), snapshot.tools.end(),
                               [](const auto& tool) { return tool.survey.unusable.empty(); });
  const char* next = log_ ? "; --resume continues it" : "";
  if (any && !fault) {
    Complain(fmt::format("stopped: the survey in {} is whole, not adjusted{}", options_.out, next));
  } else if (!any) {
    Complain(fmt::format("stopped before there was a survey: {}{}",
                         snapshot.tools.front().survey.unusable, next));
  }
  HintAtChannels(intake_.feed());
  return any && !fault && ended == Ended::kInterrupted ? kDone : kUnusable;
}

}  // namespace

int SurveyLive(const SurveyOptions& options, const JobFile& job) {
  if ((options.resume || !options.fill.empty()) && (options.record.empty() || !options.resume)) {
    Complain("--resume continues from the log given with --record; --fill goes with --resume");
    return kUsage;
  }
  for (const std::string& log : options.fill) {
    if (const auto reader = LogReader::Open(log); !reader) {
      Complain(reader.fault());
      return kUnusable;
    }
  }
  // A survey that is continued may hold what was accepted in it.
  const bool own = options.resume && HasJournal(options.out);
  if (!own && !MayWriteTo(options.out)) return kUnusable;
  Result<LiveBus> bus = LiveBus::Open(UrlOr(options.from));
  if (!bus) {
    Complain(bus.fault());
    return kUnusable;
  }
  const StopOnSignals stop(*bus);
  LiveSurvey survey(options, job, *bus);
  if (const auto fault = survey.Begin()) {
    Complain(*fault);
    return kUnusable;
  }
  SayHowHeard(*bus);
  return survey.End(survey.Run());
}

}  // namespace wellgyro::apps
