#include "wellgyro/bus/log_writer.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "wellgyro/bus/bytes_internal.h"
#include "wellgyro/bus/log_format_internal.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/record/limits.h"

namespace wellgyro {

void LogWriter::Closer::operator()(std::FILE* file) const {
  if (file != stdout) std::fclose(file);
}

LogWriter::LogWriter(std::string path, std::FILE* file) : path_(std::move(path)), file_(file) {
  // Ours is the only buffer, so that a write to the file ends with an event.
  std::setvbuf(file, nullptr, _IONBF, 0);
}

LogWriter::LogWriter(LogWriter&&) noexcept = default;

LogWriter::~LogWriter() { static_cast<void>(Close()); }

Result<LogWriter> LogWriter::Open(const std::string& path, IfExists if_exists) {
  if (path == "-") return LogWriter(path, stdout);
  std::error_code absent;
  if (if_exists == IfExists::kAppend && std::filesystem::file_size(path, absent) > 0 && !absent) {
    return Append(path);
  }
  std::FILE* file = std::fopen(path.c_str(), if_exists == IfExists::kRefuse ? "wbx" : "wb");
  if (file != nullptr) return LogWriter(path, file);
  if (errno == EEXIST) {
    return Fault{FaultCode::kIo, fmt::format("{} exists; choose another name", path), path};
  }
  return Fault{FaultCode::kIo, fmt::format("{}: cannot create: {}", path, std::strerror(errno)),
               path};
}

Result<LogWriter> LogWriter::Append(const std::string& path) {
  const auto refused = [&path] {
    return Fault{FaultCode::kIo, fmt::format("{}: cannot append: {}", path, std::strerror(errno)),
                 path};
  };
  std::int64_t next = 0, whole = 0;
  {
    Result<LogReader> reader = LogReader::Open(path);
    // Cut inside its very first event: nothing is worth keeping.
    if (!reader && reader.fault().code != FaultCode::kDamaged) return reader.fault();
    LogEvent event;
    while (reader && reader->Next(event)) {
      next = event.number + 1;
      whole = event.data_offset + static_cast<std::int64_t>(event.data.size());
    }
  }
  std::error_code error;
  std::filesystem::resize_file(path, static_cast<std::uintmax_t>(whole), error);
  std::FILE* file = error ? nullptr : std::fopen(path.c_str(), "ab");
  if (error) errno = error.value();
  if (file == nullptr) return refused();
  LogWriter writer(path, file);
  writer.events_ = next;
  writer.written_ = whole;
  return writer;
}

std::optional<Fault> LogWriter::Write(std::string_view channel, std::span<const std::byte> data,
                                      std::int64_t received_us) {
  if (channel.empty() || channel.size() > limits::kChannel) {
    throw std::invalid_argument(
        fmt::format("channel \"{}\": a name has 1 to {} bytes", channel, limits::kChannel));
  }
  if (data.size() > log_format::kDataMax) {
    throw std::invalid_argument(fmt::format("channel \"{}\": {} bytes of data are more than {}",
                                            channel, data.size(), log_format::kDataMax));
  }
  if (!file_) return fault_;
  if (fault_ && gathered_.size() + data.size() > kHeldMax) {
    ++lost_;
    return fault_;
  }
  const std::size_t at = gathered_.size();
  gathered_.resize(at + log_format::kHeadSize + channel.size() + data.size());
  std::byte* to = gathered_.data() + at;
  Store(to, log_format::kSync);
  Store(to + log_format::kNumberAt, events_);
  Store(to + log_format::kTimeAt, received_us);
  Store(to + log_format::kChannelAt, static_cast<std::uint32_t>(channel.size()));
  Store(to + log_format::kDataAt, static_cast<std::uint32_t>(data.size()));
  std::memcpy(to + log_format::kHeadSize, channel.data(), channel.size());
  if (!data.empty()) {
    std::memcpy(to + log_format::kHeadSize + channel.size(), data.data(), data.size());
  }
  ++events_;
  if (fault_) return fault_;
  return gathered_.size() >= kBlock ? Flush() : std::nullopt;
}

void LogWriter::Fail(const char* doing) {
  fault_ = Fault{FaultCode::kIo,
                 fmt::format("{}: cannot {}: {}; the log holds {} bytes of whole events", path_,
                             doing, std::strerror(errno), written_),
                 path_, written_};
}

/// Of the first `written` gathered bytes, those of whole events.
std::size_t LogWriter::WholeEvents(std::size_t written) const {
  std::size_t whole = 0;
  while (whole < written) {
    const std::byte* head = gathered_.data() + whole;
    const std::size_t next = whole + log_format::kHeadSize +
                             Load<std::uint32_t>(head + log_format::kChannelAt) +
                             Load<std::uint32_t>(head + log_format::kDataAt);
    if (next > written) break;
    whole = next;
  }
  return whole;
}

std::optional<Fault> LogWriter::Flush() {
  if (!file_ || fault_) return fault_;
  std::size_t done = 0;
  errno = 0;
  while (done < gathered_.size()) {
    done += std::fwrite(gathered_.data() + done, 1, gathered_.size() - done, file_.get());
    if (done == gathered_.size()) break;
    if (errno != EINTR) break;
    std::clearerr(file_.get());
  }
  const std::size_t whole = WholeEvents(done);
  written_ += static_cast<std::int64_t>(whole);
  const bool all = done == gathered_.size();
  gathered_.erase(gathered_.begin(), gathered_.begin() + static_cast<std::ptrdiff_t>(whole));
  if (!all) {
    Fail("write");
    std::error_code ignored;  // a pipe cannot be cut
    if (file_.get() != stdout && whole < done) {
      std::filesystem::resize_file(path_, static_cast<std::uintmax_t>(written_), ignored);
    }
  }
  return fault_;
}

std::optional<Fault> LogWriter::TryAgain() {
  if (!file_ || !fault_) return fault_;
  std::clearerr(file_.get());
  if (file_.get() != stdout) ::fseeko(file_.get(), written_, SEEK_SET);
  fault_.reset();
  return Flush();
}

bool LogWriter::Sync() const { return !file_ || ::fdatasync(::fileno(file_.get())) == 0; }

std::optional<Fault> LogWriter::Close() {
  std::optional<Fault> fault = Flush();
  if (file_ && file_.get() != stdout) static_cast<void>(Sync());
  if (std::FILE* file = file_.release(); file != nullptr && file != stdout) {
    if (std::fclose(file) != 0 && !fault_) Fail("close");
  }
  return fault ? fault : fault_;
}

std::int64_t LogWriter::bytes() const {
  return written_ + static_cast<std::int64_t>(gathered_.size());
}

bool LogWriter::InPlace() const {
  if (!file_ || file_.get() == stdout) return true;
  struct stat ours {
  }, named{};
  return ::fstat(::fileno(file_.get()), &ours) == 0 && ::stat(path_.c_str(), &named) == 0 &&
         ours.st_dev == named.st_dev && ours.st_ino == named.st_ino;
}

}  // namespace wellgyro
