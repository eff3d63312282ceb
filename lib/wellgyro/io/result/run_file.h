#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/depth/stop_match.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// What came on one channel.
struct ChannelRecord {
  std::string channel;
  std::string type;           ///< of its messages, as imu_batch_t
  std::int64_t messages = 0;  ///< accepted
  std::string sha256;         ///< over the accepted payloads, one after the other
};

/// What a survey rests on besides its messages.
struct RunRecord {
  std::string program;                      ///< name and version
  std::vector<InputFile> inputs;            ///< the job first
  std::optional<StopMatch> clock;           ///< of the tool, by its stops
  std::optional<double> stamps_less_stops;  ///< the samples' own UTC less that [s]
  std::vector<ChannelRecord> channels;
  std::vector<ToolInfo> tools;              ///< as the tools said
  std::vector<Fault> faults;                ///< of the surveyor, none of the source
  std::vector<OperationRecord> operations;  ///< what people ordered; the first of many
  std::int64_t operations_obeyed = 0, operations_refused = 0;
  /// Files of the chosen survey that others read, besides survey.csv.
  std::vector<SurveyFormat> formats;
};

/// How the messages came: what may differ between two sources of the same messages.
struct SourceRecord {
  std::string name;                            ///< URL or log, as the user wrote it
  std::string ended = {};                      ///< how a live stream ended; empty: it was a log
  std::map<std::string, std::int64_t> counts;  ///< by name, as bytes_lost
  std::vector<Fault> faults;                   ///< with their offsets
};

/// run.toml: everything that, with the messages, makes the bytes of the result again, and what came
/// of it: inputs with their SHA-256 and text, channels, tools, runs with samples, losses and north
/// fixes, checks by verdict, faults (how many of each code, and the first hundred), and the SHA-256
/// of the other result files `outputs`. Nothing in it depends on the source or on the time.
WELLGYRO_EXPORT std::string RunToml(const RunRecord& record, const Job& job, const Survey& survey,
                                    const std::vector<OutputFile>& outputs);

/// source.toml: name, counts, and every fault with its place.
WELLGYRO_EXPORT std::string SourceToml(const SourceRecord& record);

/// All files of a result, run.toml last: survey.csv, passes.csv, checks.csv, diagnosis.csv,
/// reliability.csv, stretches.csv, those of `record.formats`, source.toml, run.toml; with grid
/// columns when the job has a grid. Throws std::domain_error when a station lies outside the grid's
/// projection, std::invalid_argument as RequireFormats.
WELLGYRO_EXPORT std::vector<OutputFile> ResultFiles(const RunRecord& record,
                                                    const SourceRecord& source, const Job& job,
                                                    const Survey& survey);

/// Throws std::invalid_argument when a survey of `job` cannot be written in one of `formats`,
/// saying what the job lacks. To be asked before the survey, which should not end in that sentence.
WELLGYRO_EXPORT void RequireFormats(const Job& job, std::span<const SurveyFormat> formats);

}  // namespace wellgyro
