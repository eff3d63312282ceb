#include "wellgyro/live/log_keeper.h"

#include <chrono>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/live/observer.h"

namespace wellgyro {
namespace {}  // namespace

Result<std::unique_ptr<LogKeeper>> LogKeeper::Open(const std::string& path, IfExists if_exists,
                                                   const LiveClock& clock, Notices& notices) {
  auto lock = if_exists == IfExists::kAppend && std::filesystem::exists(path)
                  ? FileLock::Take(path)
                  : Result<FileLock>(Fault{});
  // Before anything is cut off behind the last whole event of a log that another still writes.
  if (!lock && lock.fault().code == FaultCode::kConflict) return lock.fault();
  Result<LogWriter> log = LogWriter::Open(path, if_exists);
  if (!log) return log.fault();
  if (!lock) lock = FileLock::Take(path);
  if (!lock) return lock.fault();
  return std::unique_ptr<LogKeeper>(
      new LogKeeper(path, std::move(*log), std::move(*lock), clock, notices));
}

LogKeeper::LogKeeper(std::string path, LogWriter log, FileLock lock, const LiveClock& clock,
                     Notices& notices)
    : path_(std::move(path)),
      log_(std::move(log)),
      lock_(std::move(lock)),
      clock_(clock),
      notices_(notices),
      thread_([this] { Work(); }) {}

LogKeeper::~LogKeeper() { Close(); }

void LogKeeper::Work() {
  std::unique_lock lock(mutex_);
  while (!ending_) {
    woken_.wait_for(lock, std::chrono::milliseconds(kSyncMs), [this] { return ending_; });
    if (!std::exchange(dirty_, false)) continue;
    lock.unlock();
    if (const bool synced = log_.Sync(); synced != synced_) {
      synced_ = synced;
      notices_.Say(synced ? fmt::format("{} is on the disk again", path_)
                          : fmt::format("{} cannot be forced to the disk: a loss of power may take "
                                        "what came since",
                                        path_));
    }
    lock.lock();
  }
}

void LogKeeper::Heed(const std::optional<Fault>& fault) {
  if (fault && !failing_) {
    notices_.Say(*fault);
    notices_.Say("the survey goes on; its recording is tried again every second");
    next_try_ = clock_.monotonic_us() + kSecondUs;
  } else if (!fault && failing_) {
    const std::int64_t lost = log_.lost() - std::exchange(lost_told_, log_.lost());
    notices_.Say(lost == 0
                     ? fmt::format("{} is being written again and is whole", path_)
                     : fmt::format("{} is being written again; {} messages are missing in it, for "
                                   "which there was no room in memory",
                                   path_, lost));
  }
  failing_ = fault.has_value();
}

void LogKeeper::Write(std::string_view channel, std::span<const std::byte> bytes,
                      std::int64_t received_us) {
  auto fault = log_.Write(channel, bytes, received_us);
  if (!fault) fault = log_.Flush();
  if (fault.has_value() != failing_) Heed(fault);
  const std::lock_guard lock(mutex_);
  dirty_ = true;
}

void LogKeeper::Attend() {
  const std::int64_t now = clock_.monotonic_us();
  if (now < next_try_) return;
  next_try_ = now + kSecondUs;
  if (failing_) Heed(log_.TryAgain());
  if (moved_ || log_.InPlace()) return;
  moved_ = true;
  notices_.Say(fmt::format(
      "{} was moved or removed: recording goes on in it, and --resume needs it back under that "
      "name",
      path_));
}

void LogKeeper::Close() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    woken_.notify_one();
  }
  if (!thread_.joinable()) return;
  thread_.join();
  if (failing_) Heed(log_.TryAgain());
  if (const auto fault = log_.Close(); fault && !failing_) Heed(fault);
}

}  // namespace wellgyro
