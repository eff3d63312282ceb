#include "wellgyro/io/sensor/sensor_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/sensor/clock_join_internal.h"
#include "wellgyro/io/sensor/gyro_raw.h"
#include "wellgyro/io/sensor/sensor_csv.h"
#include "wellgyro/io/sensor/sensor_layout_internal.h"
#include "wellgyro/io/sensor/sensor_rows_internal.h"
#include "wellgyro/io/sha256.h"

namespace wellgyro {
namespace {

using sensors::ClockTables;
using sensors::ForEach;
using sensors::JoinByStops;
using sensors::JoinedClocks;
using sensors::RefineByMotion;

// [s] that depth is pushed ahead of samples: more than any of them waits for, a tenth of a MB of
// marks.
constexpr double kAhead = 120;
constexpr double kStampSigmas = 3;  // P(|x| > 3) = 0.27 % of clocks that agree, one second at least
// Between pairs of clocks, over which a crystal keeps its rate [s].
constexpr double kPairEvery = 10;
constexpr std::int64_t kProgressRows = 65536;  // between reports, some a second

struct Opened {
  std::filesystem::path path;
  SensorCsv table;
};

Result<InputFile> Noted(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  Sha256 digest;
  std::array<char, 1 << 16> block{};
  while (file.read(block.data(), std::ssize(block)) || file.gcount() > 0) {
    digest.Update(std::string_view(block.data(), static_cast<std::size_t>(file.gcount())));
  }
  if (file.bad()) {
    return Fault{.code = FaultCode::kIo,
                 .text = "reading this file failed half way",
                 .source = path.string()};
  }
  return InputFile{.role = "sensors",
                   .name = path.filename().string(),
                   .path = path,
                   .sha256 = digest.HexDigest()};
}

/// UTC against the tool's clock, from the pairs that samples carry: straight between two of them,
/// at the tool's own rate before the first and after the last.
class ClockPairs {
 public:
  void Take(const SampleStamp& stamp) {
    if (!pairs_.empty() && (stamp.tool_time - pairs_.back().tool).seconds() < kPairEvery) return;
    pairs_.push_back({stamp.tool_time, stamp.utc});
  }
  /// As it is where no pair was taken: one clock serves both.
  UtcTime UtcOf(ToolTime at) const {
    if (pairs_.empty()) return UtcTime{at.ns};
    const auto after =
        std::ranges::upper_bound(pairs_, at.ns, {}, [](const Pair& pair) { return pair.tool.ns; });
    const Pair& before = after == pairs_.begin() ? *after : *(after - 1);
    const double since = (at - before.tool).seconds();
    if (after == pairs_.begin() || after == pairs_.end()) {
      return before.utc + Duration::Seconds(since);
    }
    const double rate = (after->utc - before.utc).seconds() / (after->tool - before.tool).seconds();
    return before.utc + Duration::Seconds(rate * since);
  }

 private:
  struct Pair {
    ToolTime tool;
    UtcTime utc;
  };
  std::vector<Pair> pairs_;
};

// Of two clocks that are `apart`, known to `allowed` [s]: time zones differ by quarters of an hour.
std::string WhyApart(double apart, double allowed) {
  constexpr double kQuarter = 900;
  const double zones = kQuarter * std::round(apart / kQuarter);
  if (zones == 0 || std::abs(apart - zones) > allowed) return "one of the clocks is set wrong";
  return fmt::format("one of the clocks is in a time zone, {:g} h from UTC",
                     std::abs(zones) / 3600);
}

class Joiner {
 public:
  Joiner(const Job& job, Surveyor& surveyor, Sink& faults,
         const std::function<void(double)>& progress)
      : job_(job), surveyor_(surveyor), faults_(faults), progress_(progress) {}

  Result<SensorReport> Run(std::span<const std::filesystem::path> files) {
    for (const std::filesystem::path& path : files) {
      if (const auto fault = Take(path)) return *fault;
    }
    if (const auto fault = depth_by_tool_ ? PairClocks() : JoinClocks()) return *fault;
    // Averages ask for their depth at once.
    if (samples_.empty() || !stills_.empty()) {
      if (const auto fault = PushDepth()) return *fault;
    }
    for (const StillWindow& window : gyro_raw_) {
      ++report_.windows;
      surveyor_.Push(window);
    }
    for (const auto& path : stills_) {
      const auto fault = Push<StillWindow>(path, [&](const StillWindow& window) {
        ++report_.windows;
        surveyor_.Push(window);
      });
      if (fault) return *fault;
    }
    if (!samples_.empty()) {
      if (const auto fault = PushSamples()) return *fault;
    }
    return std::move(report_);
  }

 private:
  std::optional<Fault> TakeGyroRaw(const std::filesystem::path& path) {
    const Result<SurveyTable> table = ReadSurvey(path);
    if (!table) return table.fault();
    Result<std::vector<StillWindow>> windows = WindowsOfGyroRaw(*table, job_);
    if (!windows) {
      Fault fault = windows.fault();
      fault.source = path.string();
      return fault;
    }
    const Result<InputFile> noted = Noted(path);
    if (!noted) return noted.fault();
    report_.files.push_back(*noted);
    gyro_raw_.insert(gyro_raw_.end(), windows->begin(), windows->end());
    return std::nullopt;
  }

  std::optional<Fault> Take(const std::filesystem::path& path) {
    if (IsIogpFile(path)) return TakeGyroRaw(path);
    const Result<SensorCsv> table = SensorCsv::Open(path);
    if (!table) return table.fault();
    const Result<InputFile> noted = Noted(path);
    if (!noted) return noted.fault();
    report_.files.push_back(*noted);
    const auto second = [&](std::string_view what) {
      return Fault{.code = FaultCode::kConflict,
                   .text = fmt::format("a second table of {}; give one", what),
                   .source = path.string()};
    };
    switch (table->kind()) {
      case SensorTable::kSamples:
        if (!samples_.empty()) return second("samples");
        samples_ = path;
        has_utc_ = table->has_utc();
        has_tool_ = table->has_tool();
        break;
      case SensorTable::kStill:
        stills_.push_back(path);
        break;
      case SensorTable::kDepth:
        if (!depth_.empty()) return second("depth");
        depth_ = path;
        depth_by_tool_ = !table->has_utc();
        break;
    }
    return std::nullopt;
  }

  /// Of depths on the tool's clock: what UTC they are.
  std::optional<Fault> PairClocks() {
    if (!has_tool_) {
      return Fault{.code = FaultCode::kConflict,
                   .text =
                       "the depths are on the tool's clock, which no sample has: give samples "
                       "with TOOL, or depths with UTC",
                   .source = depth_.string()};
    }
    if (!has_utc_) return std::nullopt;
    return ForEach<ImuSample>(samples_,
                              [&](const ImuSample& sample) { pairs_.Take(sample.stamp); });
  }

  /// Ties the samples' tool time to UTC by the stops, where there is anything to be learnt.
  std::optional<Fault> JoinClocks() {
    if (!has_tool_) return std::nullopt;
    if (depth_.empty()) {
      if (has_utc_) return std::nullopt;
      return Fault{.code = FaultCode::kConflict,
                   .text =
                       "the samples have the tool's time alone: give UTC, or a table of depth "
                       "whose stops tell it",
                   .source = samples_.string()};
    }
    const ClockTables tables{samples_, depth_};
    Result<JoinedClocks> joined = JoinByStops(tables, job_);
    if (!joined) {
      if (has_utc_) return std::nullopt;
      Fault why = joined.fault();
      if (why.source.empty()) why.source = samples_.string();
      return why;
    }
    StopMatch& match = joined->match;
    if (has_utc_) {
      CompareStamps(*joined);
    } else {
      if (auto fault = RefineByMotion(tables, match)) return fault;
      surveyor_.TieClock(match.Sigma(match.tool));  // the lag is a mean over the stops
    }
    report_.clock = match;
    return std::nullopt;
  }

  /// Of rows that stand there twice.
  void TellRepeated(const std::filesystem::path& path, const SensorCsv& table) {
    const auto [count, first_line] = table.repeated();
    if (count == 0) return;
    faults_.OnFault(Fault{.code = FaultCode::kOrder,
                          .text = fmt::format("{} row{} the row before again: left out", count,
                                              count == 1 ? " is" : "s are"),
                          .source = path.string(),
                          .line = first_line});
  }

  /// Every row of a table whose copies are told.
  template <class Record, class Take>
  std::optional<Fault> Push(const std::filesystem::path& path, Take take) {
    Result<SensorCsv> table = SensorCsv::Open(path);
    if (!table) return table.fault();
    auto fault = ForEach<Record>(*table, take);
    TellRepeated(path, *table);
    return fault;
  }

  void CompareStamps(const JoinedClocks& joined) {
    const auto& [match, first, last] = joined;
    const double a = (first.utc - match.ToUtc(first.tool_time)).seconds();
    const double b = (last.utc - match.ToUtc(last.tool_time)).seconds();
    report_.stamps_less_stops = std::abs(a) > std::abs(b) ? a : b;
    const double limit =
        kStampSigmas * std::max(match.Sigma(first.tool_time), match.Sigma(last.tool_time));
    if (std::abs(*report_.stamps_less_stops) <= std::max(limit, 1.0)) return;
    faults_.OnFault(Fault{
        .code = FaultCode::kConflict,
        .text = fmt::format("the samples' UTC is {:.1f} s from what the stops of tool and depth "
                            "say, {:.1f} s allowed: {}",
                            *report_.stamps_less_stops, std::max(limit, 1.0),
                            WhyApart(*report_.stamps_less_stops, std::max(limit, 1.0))),
        .source = samples_.string()});
  }

  std::optional<Fault> PushDepth() {
    if (depth_.empty()) return std::nullopt;
    return Push<DepthMark>(depth_, [&](const DepthMark& mark) {
      ++report_.marks;
      surveyor_.Push(Completed(mark));
    });
  }

  /// With the job's kind of depth and UTC.
  DepthMark Completed(DepthMark mark) const {
    if (depth_by_tool_) mark.utc = pairs_.UtcOf(ToolTime{mark.utc.ns});
    if (mark.kind == DepthKind::kIndicated) mark.kind = job_.depth.kind;
    return mark;
  }

  std::optional<Fault> PushSamples() {
    std::optional<SensorCsv> depth;
    if (!depth_.empty() && stills_.empty()) {
      Result<SensorCsv> opened = SensorCsv::Open(depth_);
      if (!opened) return opened.fault();
      depth = *std::move(opened);
    }
    SensorCsv::Row row;
    bool more = depth && depth->Next(row);
    std::error_code ignored;
    std::int64_t next_progress = kProgressRows;
    const bool by_stops = !has_utc_ && !depth_by_tool_;
    auto fault = Push<ImuSample>(samples_, [&](ImuSample sample) {
      if (by_stops) {
        sample.stamp.utc = report_.clock->ToUtc(sample.stamp.tool_time);
      } else if (!has_tool_) {
        sample.stamp.tool_time = ToolTime{sample.stamp.utc.ns};
      }
      sample.stamp.utc_unsynced = false;
      const UtcTime until = sample.stamp.utc + Duration::Seconds(kAhead);
      while (more) {
        const DepthMark mark = Completed(std::get<DepthMark>(row));
        if (mark.utc > until) break;
        ++report_.marks;
        surveyor_.Push(mark);
        more = depth->Next(row);
      }
      surveyor_.Push(sample);
      if (++report_.samples == next_progress) {
        next_progress += kProgressRows;
        if (progress_) progress_(static_cast<double>(report_.samples));
      }
    });
    if (!fault && depth) fault = depth->fault();
    if (depth) TellRepeated(depth_, *depth);
    return fault;
  }

  const Job& job_;
  Surveyor& surveyor_;
  Sink& faults_;
  const std::function<void(double)>& progress_;
  SensorReport report_;
  std::filesystem::path samples_, depth_;
  std::vector<std::filesystem::path> stills_;
  std::vector<StillWindow> gyro_raw_;
  ClockPairs pairs_;
  bool has_utc_ = false, has_tool_ = false, depth_by_tool_ = false;
};

}  // namespace

Result<SensorReport> PushSensorFiles(std::span<const std::filesystem::path> files, const Job& job,
                                     Surveyor& surveyor, Sink& faults,
                                     const std::function<void(double)>& progress) {
  return Joiner(job, surveyor, faults, progress).Run(files);
}

bool IsSensorTable(const std::filesystem::path& path) {
  if (IsIogpFile(path)) return true;
  const Result<std::string> head = ReadTextHead(path, 65536);
  if (!head || head->find('\0') != std::string::npos) return false;
  for (std::string_view rest = *head; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos || line[begin] == '#') continue;
    return sensors::LayoutOf(line).meant;
  }
  return false;
}

}  // namespace wellgyro
