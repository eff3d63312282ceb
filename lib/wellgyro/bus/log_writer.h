#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

/// kAppend: continue behind the last whole event; what a lost power supply left after it is cut
/// off.
enum class IfExists { kRefuse, kReplace, kAppend };

/// Writes an LCM log as lcm-logger does; format with LogReader. Events are gathered in memory and
/// go to the file in whole events only: when Flush is called, when kBlock bytes have gathered, and
/// at the end. A write that fails half-way (disk full) is taken back to the last whole event.
class WELLGYRO_EXPORT LogWriter {
 public:
  static constexpr std::size_t kBlock = std::size_t{1} << 20;     ///< [bytes], of one write
  static constexpr std::size_t kHeldMax = std::size_t{32} << 20;  ///< [bytes] behind a Fault

  /// `path`: a file, or "-" for standard output.
  static Result<LogWriter> Open(const std::string& path, IfExists if_exists = IfExists::kRefuse);
  ~LogWriter();  ///< flushes; call Close to hear whether that went well
  LogWriter(LogWriter&&) noexcept;
  LogWriter& operator=(LogWriter&&) = delete;

  /// `received_us`: microseconds since 1970 when the message came. Events are numbered from 0,
  /// or on from what was there.
  /// A channel of 1 to 63 bytes and at most 2^28 bytes of data, otherwise std::invalid_argument.
  /// After a Fault nothing more is written and every call gives that Fault again, until TryAgain;
  /// the events since then are held in memory as long as kHeldMax lasts, and numbered.
  [[nodiscard]] std::optional<Fault> Write(std::string_view channel,
                                           std::span<const std::byte> data,
                                           std::int64_t received_us);
  /// Everything written so far to the operating system, so that a crash of this program loses none.
  [[nodiscard]] std::optional<Fault> Flush();
  /// After a Fault: writes what is held, if the disk has room again.
  [[nodiscard]] std::optional<Fault> TryAgain();
  /// What was flushed is on the disk, so that a loss of power loses none of it; false: the system
  /// refuses. May be called from another thread than the rest.
  bool Sync() const;
  [[nodiscard]] std::optional<Fault> Close();

  /// Whether the path still names the file that is written: false once it was moved or removed.
  bool InPlace() const;

  std::int64_t events() const { return events_; }
  std::int64_t lost() const { return lost_; }  ///< events behind a Fault that found no room
  std::int64_t bytes() const;                  ///< of all events, those still in memory included

 private:
  struct Closer {
    void operator()(std::FILE* file) const;
  };
  LogWriter(std::string path, std::FILE* file);
  static Result<LogWriter> Append(const std::string& path);
  void Fail(const char* doing);
  std::size_t WholeEvents(std::size_t written) const;

  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::vector<std::byte> gathered_;
  std::int64_t events_ = 0, lost_ = 0;
  std::int64_t written_ = 0;  // bytes in the file, whole events
  std::optional<Fault> fault_;
};

}  // namespace wellgyro
