#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

/// @file
/// An LCM log, event by event, with what is damaged in it.
namespace wellgyro {

/// One event of an LCM log. The views hold until the next call of LogReader::Next.
struct LogEvent {
  std::int64_t number = 0;       ///< as the logger counted; restarts where a log was appended to
  std::int64_t received_us = 0;  ///< when the logger got it, by the logger's clock, since 1970
  std::string_view channel;
  std::span<const std::byte> data;
  std::int64_t data_offset = 0;  ///< of `data` in the log
};

/// Bytes of a log that belong to no event.
struct LogGap {
  std::int64_t offset = 0;
  std::int64_t length = 0;
};

/// How a log was, as far as it has been read.
struct LogHealth {
  static constexpr std::size_t kGapsMax = 1000;  ///< told by place; more are counted only

  std::int64_t events = 0;
  std::int64_t bytes = 0;       ///< read so far, gaps included
  std::int64_t lost_bytes = 0;  ///< in gaps, the cut end not included
  std::int64_t gap_count = 0;
  std::vector<LogGap> gaps;   ///< the first kGapsMax
  std::optional<LogGap> cut;  ///< the log ends inside an event, which begins here
  std::optional<Fault> io;    ///< the system stopped reading
};

/// Reads LCM's log format (sync word ED A1 DA 01, event number, time, lengths, channel, data; all
/// big-endian) event by event: a regular file through a memory map, a pipe through a buffer that
/// holds one event (at most 2^28 bytes and its head).
///
/// The format has no checksum. What is damaged shows by the sync words and lengths alone: an event
/// whose length does not lead to the next one is dropped only where another begins inside it, and
/// the search goes on behind its first byte, so that good events before and after a damaged one are
/// all delivered. A payload cut short by a damaged length is delivered as it is; its decoder
/// refuses it by size. A log cut between two events is simply shorter; one cut inside an event says
/// so in LogHealth.
///
/// On a pipe an event is delivered once the head of the next has come. A file that is made shorter
/// while it is mapped ends the process (SIGBUS); one that grows is read to the size it had.
class WELLGYRO_EXPORT LogReader {
 public:
  /// `path`: a file, a FIFO, or "-" for standard input. Looks for the first event; where there is
  /// none the Fault says what the file is instead.
  static Result<LogReader> Open(const std::string& path);
  /// The same of a regular file from byte `from` on, where an event ends: what has been added since
  /// it was read so far. Nothing added is no Fault; a `from` below 0 is one.
  static Result<LogReader> OpenAt(const std::string& path, std::int64_t from);
  ~LogReader();
  LogReader(LogReader&&) noexcept;
  LogReader& operator=(LogReader&&) noexcept;

  /// The next event; false at the end.
  bool Next(LogEvent& event);

  const LogHealth& health() const;
  /// What health() has to complain of: one Fault for each gap, one for the end.
  std::vector<Fault> Faults() const;

 private:
  class Parser;
  explicit LogReader(std::unique_ptr<Parser> parser);
  std::unique_ptr<Parser> parser_;
};

}  // namespace wellgyro
