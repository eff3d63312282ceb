#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/bus/file_lock.h"
#include "wellgyro/bus/latency.h"
#include "wellgyro/bus/loss_watch.h"
#include "wellgyro/bus/stream_guard.h"
#include "wellgyro/live/adviser.h"
#include "wellgyro/live/broadcast.h"
#include "wellgyro/live/catch_up.h"
#include "wellgyro/live/intake.h"
#include "wellgyro/live/log_keeper.h"
#include "wellgyro/live/notices.h"
#include "wellgyro/live/result_keeper.h"
#include "wellgyro/live/session.h"
#include "wellgyro/live/watchdog.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// A live session at work. All but Stop, and what the watchdog calls, is of one thread.
struct LiveSession::Core {
  using Ended = LiveOutcome::Ended;

  Core(LiveSetup the_setup, const RunAdjuster* adjuster, LiveObserver& observer, LiveBus the_bus);

  std::optional<Fault> Begin();
  Ended Work();
  LiveOutcome End(Ended ended);
  void Stop() noexcept;

  void Hear(std::string_view channel, std::span<const std::byte> bytes, std::int64_t received_us);
  void Use(std::string_view channel, std::span<const std::byte> bytes, std::int64_t received_us,
           bool record);
  bool ComesFromElsewhere(std::string_view channel, std::span<const std::byte> bytes);
  void TellOf(const OperationRecord& record, bool event);
  std::optional<Fault> TakeFolder();
  std::optional<Fault> BeginRecord();
  Result<bool> Resume();
  bool DrainStopped();
  void Housekeeping();
  bool FinishIsDue(std::int64_t now);
  void SendStatus(std::int64_t now);
  Status StatusNow(bool on_time);
  void Worsen(Status& status) const;
  void SendLate();
  Glance GlanceNow() const;
  void Advise(std::int64_t now);
  void NoteChecks(const std::vector<ToolResult>& tools);
  void EmptyOutbox();
  std::optional<Fault> WriteLast(const Snapshot& snapshot, bool patient);
  void KeepFiles(std::int64_t now);
  Snapshot Take() const;
  SourceRecord Source() const;
  std::int64_t Now() const { return setup.clock.monotonic_us(); }

  LiveSetup setup;
  Notices notices;
  LiveBus bus;
  Broadcast broadcast;
  Surveyor surveyor;
  Intake intake;
  LossWatch watch;
  StreamGuard guard;
  CatchUp catch_up;
  ResultKeeper keeper;
  std::optional<FileLock> folder;
  std::unique_ptr<LogKeeper> log;
  bool resuming = false;
  Latency message_latency, station_latency;
  std::unique_ptr<Adviser> adviser;  ///< null: nobody asked
  std::int64_t next_status = 0, next_keep = 0, next_advice = 0;
  std::int64_t kept_news = 0;
  std::int64_t sample_messages = 0, last_sample_us = 0;
  std::int64_t kernel_drops_said = 0;
  std::int64_t orders_from_elsewhere = 0;
  std::map<std::string, Verdict> verdicts;  ///< of the last files, by check
  std::string turned;
  std::mutex status_mutex;
  Status last_status;               ///< for the watchdog to say again, and ...
  std::int64_t last_status_us = 0;  ///< ... when it was said
  std::unique_ptr<Watchdog> watchdog;
};

}  // namespace wellgyro
