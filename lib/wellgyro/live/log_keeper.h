#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/bus/file_lock.h"
#include "wellgyro/bus/log_writer.h"
#include "wellgyro/live/notices.h"
#include "wellgyro/live/observer.h"

namespace wellgyro {

/// The recording of a live session, kept to it by a lock. Each message is handed to the system
/// before it is used, and forced to the disk every kSync, from a thread of its own: a loss of power
/// takes no more than that. A disk that is full or gone is tried again every second; meanwhile
/// LogWriter::kHeldMax bytes are held, and what finds no room in them is counted.
class WELLGYRO_EXPORT LogKeeper {
 public:
  static constexpr std::int64_t kSyncMs = 1000;  ///< of data that a loss of power may take

  /// `clock` and `notices` must outlive the object.
  static Result<std::unique_ptr<LogKeeper>> Open(const std::string& path, IfExists if_exists,
                                                 const LiveClock& clock, Notices& notices);
  ~LogKeeper();
  LogKeeper(const LogKeeper&) = delete;
  LogKeeper& operator=(const LogKeeper&) = delete;

  /// In the session's thread. Never fails for the caller: a full disk is told to `notices` and
  /// tried again.
  void Write(std::string_view channel, std::span<const std::byte> bytes, std::int64_t received_us);
  /// To be called now and then: tries a disk again, looks whether the log is in its place.
  void Attend();
  void Close();

  bool failing() const { return failing_; }  ///< the disk takes nothing at present
  bool moved() const { return moved_; }      ///< the log was renamed or removed under the session
  std::int64_t lost() const { return log_.lost(); }  ///< messages that are in no recording

 private:
  LogKeeper(std::string path, LogWriter log, FileLock lock, const LiveClock& clock,
            Notices& notices);
  void Heed(const std::optional<Fault>& fault);
  void Work();

  std::string path_;
  LogWriter log_;
  FileLock lock_;
  const LiveClock& clock_;
  Notices& notices_;
  bool failing_ = false, moved_ = false;
  std::int64_t next_try_ = 0, lost_told_ = 0;
  std::mutex mutex_;
  std::condition_variable woken_;
  bool dirty_ = false, ending_ = false;
  bool synced_ = true;  ///< the thread's
  std::thread thread_;
};

}  // namespace wellgyro
