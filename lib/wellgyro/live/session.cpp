#include "wellgyro/live/session.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/core.h>

#include "wellgyro/bus/decode.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/io/result/result_folder.h"
#include "wellgyro/live/journal.h"
#include "wellgyro/live/observer.h"
#include "wellgyro/live/session_core_internal.h"
#include "wellgyro/survey/run_adjuster.h"

namespace wellgyro {
namespace {

// What is still used of a backlog when the session is stopped.
constexpr std::int64_t kDrainUs = 200'000;
// Within which the receiver's thread hands over what the system holds for it already.
constexpr int kQuietMs = 20;
// Waited at most for a message: Broadcast's pause while stations wait to be sent, else a tenth of
// the second in which a status is due.
constexpr std::int64_t kPumpMs = 10, kIdleMs = 100;
// Messages used between two looks at what else there is to do.
constexpr std::int64_t kAtOnce = 200;

constexpr MessageType kInputs[] = {MessageType::kRawBatch,    MessageType::kImuBatch,
                                   MessageType::kStillWindow, MessageType::kDepth,
                                   MessageType::kToolMode,    MessageType::kToolInfo,
                                   MessageType::kEvent,       MessageType::kCommand};

/// What in a setup cannot be, before anything is opened.
std::optional<Fault> Complaint(const LiveSetup& setup) {
  if (!setup.clock.utc_us || !setup.clock.monotonic_us) {
    throw std::invalid_argument(fmt::format("live session: the clock has no {}",
                                            setup.clock.utc_us ? "monotonic_us" : "utc_us"));
  }
  if (setup.out.empty()) {
    return Fault{FaultCode::kSyntax,
                 "a session needs a folder for its result: set `out`, --out of the program"};
  }
  if ((setup.resume || !setup.fill.empty()) && (setup.record.empty() || !setup.resume)) {
    return Fault{FaultCode::kSyntax,
                 "a session resumes from the log that it recorded; logs that fill it go with that"};
  }
  for (const std::string& log : setup.fill) {
    if (const auto reader = LogReader::Open(log); !reader) return reader.fault();
  }
  // A survey that is continued may hold what was accepted in it.
  const bool own = setup.resume && HasJournal(setup.out);
  return own ? std::nullopt : AcceptedIn(setup.out);
}

}  // namespace

bool LiveOutcome::usable() const { return AnyUsable(tools); }

bool LiveOutcome::losses() const {
  return !recording_is_whole ||
         std::any_of(tools.begin(), tools.end(), [this](const ToolResult& tool) {
           return !tool.survey.unusable.empty() || HasLosses(*source, tool.survey);
         });
}

void AdjustBy(const RunAdjuster& adjuster, LiveSession& session) {
  AdjustBy(adjuster, session.core_->surveyor);
}

LiveSession::LiveSession(std::unique_ptr<Core> core) : core_(std::move(core)) {}
LiveSession::~LiveSession() = default;

Result<std::unique_ptr<LiveSession>> LiveSession::Open(LiveSetup setup, LiveObserver& observer) {
  if (auto fault = Complaint(setup)) return *std::move(fault);
  Result<LiveBus> bus = LiveBus::Open(setup.url.empty() ? kDefaultLcmUrl : setup.url);
  if (!bus) return bus.fault();
  auto core = std::make_unique<Core>(std::move(setup), observer, std::move(*bus));
  if (auto fault = core->Begin()) return *std::move(fault);
  return std::unique_ptr<LiveSession>(new LiveSession(std::move(core)));
}

const LiveBus& LiveSession::bus() const { return core_->bus; }
void LiveSession::Stop() noexcept { core_->Stop(); }
LiveOutcome LiveSession::Run() {
  if (std::exchange(core_->ran, true)) {
    throw std::logic_error("LiveSession::Run: a session runs once");
  }
  const LiveOutcome::Ended ended = core_->Work();
  return core_->End(ended);
}

LiveSession::Core::Core(LiveSetup the_setup, LiveObserver& observer, LiveBus the_bus)
    : setup(std::move(the_setup)),
      notices(observer, setup.clock),
      bus(std::move(the_bus)),
      broadcast(bus, setup.job.job.channels, setup.clock, notices),
      surveyor(setup.job.job, broadcast),
      intake(setup.job, surveyor),
      watch([this](const Fault& fault) { notices.Tell(fault); }),
      guard(
          setup.job.job.channels,
          [this](const StreamGuard::Message& m) { Use(m.channel, m.bytes, m.received_us, true); },
          [this](const std::string& sentence) { notices.Say(sentence); }),
      catch_up(setup.job.job.channels, setup.clock, notices,
               [this](auto channel, auto bytes, auto received_us, bool fresh) {
                 Use(channel, bytes, received_us, fresh);
               }),
      keeper(setup.job.job, notices),
      reporter({setup.clock, bus, surveyor, intake, keeper, broadcast, notices,
                setup.job.job.alignment.min_still}) {
  if (setup.advise) adviser = std::make_unique<Adviser>(*setup.advise);
  intake.Watch(watch);
  intake.Tell([this](const OperationRecord& record, bool event) { TellOf(record, event); });
  watchdog = std::make_unique<Watchdog>(
      setup.clock, [this] { reporter.Repeat(); },
      [this] {
        // What is known of the survey so far is in the files; nothing may be half-way then.
        keeper.End();
        notices.With([this](LiveObserver& to) { to.OnStuck(keeper.kept()); });
      });
}

void LiveSession::Core::Stop() noexcept {
  watchdog->Ending();
  bus.Stop();
}

std::optional<Fault> LiveSession::Core::Begin() {
  resuming = setup.resume;
  if (auto fault = TakeFolder()) return fault;
  // Heard from now on, so that nothing falls between the logs and the stream.
  std::vector<std::string> channels;
  for (const MessageType type : kInputs) {
    channels.push_back(NameOf(setup.job.job.channels, type));
  }
  if (auto fault = bus.Subscribe(channels, [this](auto channel, auto bytes, auto received_us) {
        Hear(channel, bytes, received_us);
      })) {
    return fault;
  }
  if (!setup.record.empty()) {
    if (auto fault = BeginRecord()) return fault;
  }
  // Now and not at each writing: a report that is made on the way stays.
  RemoveOlder(setup.out, {});
  return std::nullopt;
}

std::optional<Fault> LiveSession::Core::TakeFolder() {
  std::error_code error;
  std::filesystem::create_directories(setup.out, error);
  if (error) {
    return Fault{FaultCode::kIo, fmt::format("{}: cannot be made: {}", setup.out, error.message()),
                 setup.out};
  }
  Result<FileLock> lock = FileLock::Take(setup.out);
  if (!lock) return lock.fault();
  folder.emplace(std::move(*lock));
  return std::nullopt;
}

/// The journal before the log: where there is a log there is what it takes to continue it.
std::optional<Fault> LiveSession::Core::BeginRecord() {
  Journal journal = JournalOf(setup.job, setup.record, resuming ? 0 : setup.clock.utc_us());
  if (resuming) {
    if (!HasJournal(setup.out)) {
      notices.Say(fmt::format("{} holds no survey to resume: one begins there", setup.out));
    }
    const Result<Journal> left = ReadJournal(setup.out, journal);
    if (!left) return left.fault();
    journal = *left;
    RemovePartials(setup.out);
    broadcast.Mute(true);
    if (auto fault = catch_up.OwnLog(setup.record, journal.begun_us)) return fault;
  } else if (std::filesystem::exists(setup.record)) {
    return Fault{FaultCode::kConflict,
                 "exists already: --resume continues it, or give another name", setup.record};
  }
  if (auto fault = WriteJournal(setup.out, journal)) return fault;
  auto opened = LogKeeper::Open(setup.record, resuming ? IfExists::kAppend : IfExists::kRefuse,
                                setup.clock, notices);
  if (!opened) return opened.fault();
  log = std::move(*opened);
  reporter.Watch(*log);
  return std::nullopt;
}

void LiveSession::Core::TellOf(const OperationRecord& record, bool event) {
  if (resuming) return;
  if (event && record.id != 0) broadcast.OnAcknowledged(record.id);
  std::string by = record.key + (record.who.empty() ? "" : ", " + Printable(record.who));
  std::string what = fmt::format("{} of {}, session {}, number {}: {}", record.kind, by,
                                 record.session, record.id, record.effect);
  // Of what is refused there may be any number.
  if (record.obeyed) {
    notices.Say(what);
  } else {
    notices.Tell({FaultCode::kConflict, std::move(what)});
  }
}

/// An unsigned order from elsewhere, where the job lists nobody who may give one.
bool LiveSession::Core::ComesFromElsewhere(std::string_view channel,
                                           std::span<const std::byte> bytes) {
  if (bus.heard_here() || !setup.job.operations.keys.empty()) return false;
  const auto type = TypeOn(setup.job.job.channels, channel, bytes);
  const bool order = type == MessageType::kEvent || type == MessageType::kCommand ||
                     type == MessageType::kToolMode || type == MessageType::kToolInfo;
  if (!order) return false;
  ++orders_from_elsewhere;
  notices.Tell({FaultCode::kConflict,
                fmt::format("{} from another machine is not obeyed: list an [[operator]] in the "
                            "job and sign it with wellgyro send",
                            TypeName(*type))});
  return true;
}

void LiveSession::Core::Hear(std::string_view channel, std::span<const std::byte> bytes,
                             std::int64_t received_us) {
  if (ComesFromElsewhere(channel, bytes)) return;
  // While logs are joined with what is heard, a message that waits would be used by both.
  if (resuming) return catch_up.Hold(channel, bytes, received_us);
  guard.Take({channel, bytes, received_us, bus.heard_from()});
}

void LiveSession::Core::Use(std::string_view channel, std::span<const std::byte> bytes,
                            std::int64_t received_us, bool record) {
  // What comes after FINISH is no part of the survey, nor of its log.
  if (surveyor.finished()) return;
  // Who asks to hear something again changes nothing.
  if (const auto type = TypeOn(setup.job.job.channels, channel, bytes);
      type == MessageType::kRequest) {
    const Result<Message> request = Decode(*type, bytes);
    if (request) broadcast.SayAgain(std::get<StationRequest>(*request).from_revision);
    return;
  }
  // Written before it is used: whatever has left this program can be made again.
  if (record && log) log->Write(channel, bytes, received_us);
  const std::int64_t stations = broadcast.stations();
  intake.Take(channel, bytes);
  if (resuming) return;
  reporter.Used(setup.clock.utc_us() - received_us, broadcast.stations() > stations);
}

Result<bool> LiveSession::Core::Resume() {
  auto stopped = catch_up.FillAndJoin(bus, setup.fill);
  resuming = false;
  broadcast.Mute(false);
  if (!stopped) return stopped;
  for (const std::int32_t tool : surveyor.tools()) {
    for (const Station& station : surveyor.Current(tool).passes) broadcast.OnStation(station);
  }
  notices.Say(fmt::format("resumed after {} samples", surveyor.tally().received));
  return stopped;
}

LiveOutcome::Ended LiveSession::Core::Work() {
  if (resuming) {
    const auto stopped = Resume();
    if (!stopped) {
      notices.Say(stopped.fault());
      return Ended::kBusLost;
    }
    if (*stopped) return Ended::kInterrupted;
  }
  reporter.Begin();
  for (;;) {
    Housekeeping();
    if (surveyor.finished()) return Ended::kFinished;
    const std::int64_t wait = std::max<std::int64_t>(reporter.next_us() - Now(), 0) / 1000 + 1;
    const std::int64_t most = broadcast.waiting() ? kPumpMs : kIdleMs;
    const auto woken = bus.Wait(static_cast<int>(std::min(wait, most)), kAtOnce);
    if (!woken) {
      notices.Say(woken.fault());
      return Ended::kBusLost;
    }
    if (*woken != LiveBus::Woken::kStopped) continue;
    return DrainStopped() ? Ended::kFinished : Ended::kInterrupted;
  }
}

/// What had come before the stop, as far as there is time; true: a FINISH was among it, or waits
/// for samples, of which none come any more.
bool LiveSession::Core::DrainStopped() {
  const std::int64_t end = Now() + kDrainUs;
  while (Now() < end && !surveyor.finished()) {
    const auto drained = bus.Drain(1, kQuietMs);
    if (!drained || *drained == 0) break;
  }
  guard.Flush();
  if (intake.operations().finish_obeyed()) surveyor.Finish();
  return surveyor.finished();
}

void LiveSession::Core::Housekeeping() {
  const std::int64_t now = Now();
  watchdog->Alive();
  if (finish.IsOver(intake, now)) {
    guard.Flush();
    surveyor.Finish();
  }
  if (log) log->Attend();
  broadcast.Pump();
  if (now >= reporter.next_us() || broadcast.must_acknowledge()) reporter.Report(now);
  if (now >= next_keep) KeepFiles(now);
  if (!adviser) return;
  if (const auto advice = adviser->Attend(surveyor, now)) broadcast.Send(*advice);
}

}  // namespace wellgyro
