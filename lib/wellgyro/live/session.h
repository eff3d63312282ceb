#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/live/observer.h"
#include "wellgyro/survey/survey.h"

/// @file
/// A survey of a live stream: hears, records, surveys, and keeps its files whole.
namespace wellgyro {

/// One tool's survey, and the folder that its files go to: the one given where a single tool has a
/// survey, tool-N in it for several. A tool without a survey, which may be no more than a damaged
/// number in a message, takes no folder of its own.
struct ToolResult {
  std::int32_t tool = 0;
  std::filesystem::path folder;
  Survey survey;
};

class LiveBus;
class RunAdjuster;
struct AdviceCase;
struct RunRecord;
struct SourceRecord;

/// What a live session is asked to do.
struct LiveSetup {
  JobFile job;
  std::string url = {};           ///< of the bus; empty: LCM's own default, this machine only
  std::string out;                ///< folder of the result
  std::string record = {};        ///< log of what is heard; empty: none
  bool resume = false;            ///< continues what was cut off, from `record`
  std::vector<std::string> fill;  ///< with resume: other recorders' logs
  std::vector<SurveyFormat> formats;
  std::string program = "wellgyro";  ///< name and version of who writes the result, for run.toml
  LiveClock clock;                   ///< both functions are needed
  std::shared_ptr<const AdviceCase> advise = {};  ///< null: it gives no advice
};

/// How a session came to its end, and what is in its folder then.
struct LiveOutcome {
  enum class Ended { kFinished, kInterrupted, kBusLost };
  Ended ended = Ended::kFinished;
  std::vector<ToolResult> tools;               ///< one at least
  std::shared_ptr<const RunRecord> record;     ///< what run.toml says of it
  std::shared_ptr<const SourceRecord> source;  ///< what source.toml says of it
  std::optional<Fault> fault;                  ///< the files could not be written
  std::vector<std::string> hints;              ///< what the job might lack
  bool recording_is_whole = true;              ///< what was used is in the log

  WELLGYRO_EXPORT bool usable() const;  ///< of one tool at least
  WELLGYRO_EXPORT bool losses() const;
};

/// A survey of a live stream: hears, records, surveys, publishes stations and status, and keeps the
/// files in its folder whole at every moment. What it makes is what the recording gives when it is
/// surveyed, to the byte; killed at any instant, it resumes from the recording.
///
/// A session holds its folder and its log for itself (FileLock). It ends with FINISH, whose samples
/// may stay out for five seconds, with Stop, or when the bus is gone. One thread runs it; two more
/// write files and watch that the status goes on while the survey is adjusted.
class WELLGYRO_EXPORT LiveSession {
 public:
  /// Listens from here on. `observer` must outlive the session. A Fault says what to do: nothing
  /// has been written then. Throws std::invalid_argument when the job makes no sense or a
  /// function of the clock is empty.
  static Result<std::unique_ptr<LiveSession>> Open(LiveSetup setup, LiveObserver& observer);
  ~LiveSession();
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  const LiveBus& bus() const;

  /// Until the end; once: a second call throws std::logic_error.
  LiveOutcome Run();
  /// Ends Run within two seconds, or calls LiveObserver::OnStuck. For signal handlers too.
  void Stop() noexcept;

 private:
  /// As of a Surveyor, before Run.
  friend WELLGYRO_EXPORT void AdjustBy(const RunAdjuster& adjuster, LiveSession& session);
  struct Core;
  explicit LiveSession(std::unique_ptr<Core> core);
  std::unique_ptr<Core> core_;
};

}  // namespace wellgyro
