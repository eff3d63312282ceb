#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "wellgyro/bus/file_lock.h"
#include "wellgyro/bus/loss_watch.h"
#include "wellgyro/bus/stream_guard.h"
#include "wellgyro/live/adviser.h"
#include "wellgyro/live/broadcast.h"
#include "wellgyro/live/catch_up.h"
#include "wellgyro/live/finish_wait.h"
#include "wellgyro/live/intake.h"
#include "wellgyro/live/log_keeper.h"
#include "wellgyro/live/notices.h"
#include "wellgyro/live/reporter.h"
#include "wellgyro/live/result_keeper.h"
#include "wellgyro/live/session.h"
#include "wellgyro/live/watchdog.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// A live session at work. All but Stop, and what the watchdog calls, is of one thread.
struct LiveSession::Core {
  using Ended = LiveOutcome::Ended;

  Core(LiveSetup the_setup, LiveObserver& observer, LiveBus the_bus);

  /// Takes the folder, subscribes, and opens or resumes the log. A Fault: nothing has been written.
  std::optional<Fault> Begin();
  /// The session's loop: hears, uses, publishes, keeps files, until it ends.
  Ended Work();
  /// Settles what waits and writes the last files.
  LiveOutcome End(Ended ended);
  /// From a signal handler or another thread.
  void Stop() noexcept;

  /// A message off the bus: held while logs are joined with what is heard, else to the guard, which
  /// hands it to Use.
  void Hear(std::string_view channel, std::span<const std::byte> bytes, std::int64_t received_us);
  /// A message into the survey, live or from a log; `record`: into the log first.
  void Use(std::string_view channel, std::span<const std::byte> bytes, std::int64_t received_us,
           bool record);
  /// An order of a sender outside this machine, where unsigned ones are obeyed from here only.
  bool ComesFromElsewhere(std::string_view channel, std::span<const std::byte> bytes);
  /// What became of an order, to the observer and onto the bus.
  void TellOf(const OperationRecord& record, bool event);
  /// Makes the folder and locks it: one session writes there.
  std::optional<Fault> TakeFolder();
  std::optional<Fault> BeginRecord();
  /// Joins logs and stream, then tells all stations; true: stopped meanwhile.
  Result<bool> Resume();
  /// Uses what had come before Stop, for kDrainUs at most; true: a FINISH among it ended the
  /// survey.
  bool DrainStopped();
  /// What is due besides messages: status, files, advice, the log's disk.
  void Housekeeping();
  /// Sends stations that still wait, before the end.
  void EmptyOutbox();
  /// The last files; `patient`: tries a full disk again until Stop.
  std::optional<Fault> WriteLast(const Snapshot& snapshot, bool patient);
  /// Hands a snapshot to the keeper when there is news and it is due.
  void KeepFiles(std::int64_t now);
  /// All tools' surveys and the records beside them, as they are now.
  Snapshot Take() const;
  /// How the stream came: counts of messages, losses, drops.
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
  Reporter reporter;
  FinishWait finish;
  std::optional<FileLock> folder;
  std::unique_ptr<LogKeeper> log;
  bool resuming = false;
  std::unique_ptr<Adviser> adviser;  ///< null: nobody asked
  bool ran = false;                  ///< Run was called
  std::int64_t next_keep = 0, kept_news = 0;
  std::int64_t orders_from_elsewhere = 0;
  std::unique_ptr<Watchdog> watchdog;
};

}  // namespace wellgyro
