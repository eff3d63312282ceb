#pragma once

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/io/result/run_file.h"
#include "wellgyro/live/notices.h"
#include "wellgyro/live/results.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// A survey at one moment, for its files.
struct Snapshot {
  std::filesystem::path folder;
  std::vector<ToolResult> tools;
  RunRecord record;
  SourceRecord source;
};

/// Keeps the files of a running survey up to date from a thread of its own, so that neither a slow
/// disk nor a full one holds up the stream. Every file is whole at every moment.
class WELLGYRO_EXPORT ResultKeeper {
 public:
  /// Both must outlive this object.
  ResultKeeper(const Job& job, Notices& notices);
  ~ResultKeeper();
  ResultKeeper(const ResultKeeper&) = delete;
  ResultKeeper& operator=(const ResultKeeper&) = delete;

  /// Writes `snapshot` when what is being written is done; the newest wins.
  void Keep(Snapshot snapshot);
  /// Nothing is being written or waits to be, and the last writing went well.
  bool idle() const;
  bool failing() const;  ///< the last writing went wrong
  /// The verdict in the files, the worst of the tools'; nothing: no survey has been written.
  std::optional<RunVerdict> kept() const;

  /// Ends the thread after what it is writing, leaving out what waits.
  void End();

  /// Writes at once, in the caller's thread. Tools without a survey yet are left out.
  static std::optional<Fault> Write(const Job& job, const Snapshot& snapshot);

 private:
  void Work();

  const Job& job_;
  Notices& notices_;
  mutable std::mutex mutex_;
  std::condition_variable woken_;
  std::optional<Snapshot> waiting_;
  bool writing_ = false;
  bool failing_ = false;
  bool ending_ = false;
  std::optional<RunVerdict> kept_;
  std::thread thread_;
};

}  // namespace wellgyro
