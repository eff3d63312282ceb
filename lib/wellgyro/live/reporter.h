#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/bus/latency.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/io/result/run_file.h"
#include "wellgyro/live/broadcast.h"
#include "wellgyro/live/intake.h"
#include "wellgyro/live/log_keeper.h"
#include "wellgyro/live/notices.h"
#include "wellgyro/live/observer.h"
#include "wellgyro/live/result_keeper.h"
#include "wellgyro/live/session.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/glance.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// What a live session says of itself once a second: its status, and a glance for a screen. All but
/// Repeat is of the session's thread.
class WELLGYRO_EXPORT Reporter {
 public:
  /// What it looks at and speaks through; all must outlive the reporter.
  struct Session {
    const LiveClock& clock;
    const LiveBus& bus;
    const Surveyor& surveyor;
    const Intake& intake;
    const ResultKeeper& keeper;
    Broadcast& broadcast;
    Notices& notices;
    double still_needed = 0;  ///< what a gyrocompass takes [s]
  };
  explicit Reporter(const Session& session) : session_(session) {}

  /// The session has a recording, which must outlive the reporter.
  void Watch(const LogKeeper& log) { log_ = &log; }
  /// The first status is due now.
  void Begin();
  std::int64_t next_us() const { return next_us_; }  ///< when a status is due, by monotonic_us

  /// A message was used, and whether it gave a station, this long after it was received.
  void Used(std::int64_t delay_us, bool gave_station);
  /// The verdicts of the checks as the files have them now.
  void Note(const std::vector<ToolResult>& tools);

  /// The status now, with a glance where one is due.
  void Report(std::int64_t now);
  /// The status now, at fault for the reason given.
  void ReportFault(std::string_view reason);
  /// From the watchdog's thread: the last status again, busy.
  void Repeat();

  /// Into `source` how late messages and stations were.
  void CountLatencies(SourceRecord& source) const;

 private:
  Status StatusNow(bool on_time);
  /// Degraded, or at fault where recording or files cannot be written; why, in its text.
  void Worsen(Status& status) const;
  Glance GlanceNow() const;

  const Session session_;
  const LogKeeper* log_ = nullptr;  ///< null: none
  std::int64_t next_us_ = 0;
  std::int64_t kernel_drops_said_ = 0;
  Latency message_latency_, station_latency_;
  std::map<std::string, Verdict> verdicts_;  ///< of the last files, by check
  std::string turned_;                       ///< which of them changed last, and to what
  std::mutex mutex_;
  Status last_;                          ///< for Repeat, and ...
  std::optional<std::int64_t> last_us_;  ///< ... when it was said, if one was
};

}  // namespace wellgyro
