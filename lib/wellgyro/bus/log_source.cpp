#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "wellgyro/bus/log_source_internal.h"

namespace wellgyro {
namespace {

// [bytes], of one read: the cost of the calls is nothing then.
constexpr std::size_t kBlock = std::size_t{1} << 20;

Fault SystemFault(const std::string& path, const char* doing) {
  return {FaultCode::kIo, fmt::format("{}: cannot {}: {}", path, doing, std::strerror(errno)),
          path};
}

}  // namespace

Result<LogSource> LogSource::Open(const std::string& path) {
  LogSource source;
  source.path_ = path;
  const int descriptor =
      path == "-" ? ::dup(STDIN_FILENO) : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return SystemFault(path, "open");
  source.descriptor_ = descriptor;
  struct stat info {};
  if (::fstat(descriptor, &info) != 0) return SystemFault(path, "look at");
  if (S_ISDIR(info.st_mode)) {
    return Fault{FaultCode::kForeign, fmt::format("{} is a directory, not an LCM log", path), path};
  }
  if (!S_ISREG(info.st_mode)) return source;
  const off_t begin = path == "-" ? ::lseek(descriptor, 0, SEEK_CUR) : 0;
  if (begin != 0) return source;  // standard input that someone has read from
  const auto size = static_cast<std::size_t>(info.st_size);
  // Files of /proc are regular and say they are empty; reading tells.
  if (size == 0) return source;
  if (auto fault = source.Map(descriptor, size)) return *std::move(fault);
  return source;
}

std::optional<Fault> LogSource::Map(int descriptor, std::size_t size) {
  void* map = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (map == MAP_FAILED) return SystemFault(path_, "map");
  map_ = {static_cast<std::byte*>(map), size};
  view_ = map_;
  ::madvise(map, size, MADV_SEQUENTIAL);  // a hint; nothing depends on it
  ::close(std::exchange(descriptor_, -1));
  return std::nullopt;
}

LogSource::LogSource(LogSource&& other) noexcept
    : path_(std::move(other.path_)),
      view_(std::exchange(other.view_, {})),
      offset_(other.offset_),
      map_(std::exchange(other.map_, {})),
      descriptor_(std::exchange(other.descriptor_, -1)),
      buffer_(std::move(other.buffer_)),
      fault_(std::move(other.fault_)) {}

LogSource::~LogSource() {
  if (!map_.empty()) ::munmap(map_.data(), map_.size());
  if (descriptor_ >= 0) ::close(descriptor_);
}

/// Moves the view to the front of a buffer that has room behind it. The buffer grows as bytes come,
/// not as a length in a damaged head promises.
void LogSource::MakeRoom(std::size_t size) {
  const std::size_t have = view_.size();
  const std::size_t wanted = std::max(kBlock, std::min(size, 2 * have));
  const auto used = view_.empty() ? 0 : static_cast<std::size_t>(view_.data() - buffer_.data());
  if (used + have < buffer_.size() && used + size <= buffer_.size()) return;
  if (used > 0) std::memmove(buffer_.data(), view_.data(), have);
  if (buffer_.size() < wanted) buffer_.resize(wanted);
  view_ = {buffer_.data(), have};
}

bool LogSource::Read(std::size_t size) {
  while (view_.size() < size && descriptor_ >= 0) {
    MakeRoom(size);
    if (view_.empty()) view_ = {buffer_.data(), 0};
    const auto end = static_cast<std::size_t>(view_.data() - buffer_.data()) + view_.size();
    const ssize_t got = ::read(descriptor_, buffer_.data() + end, buffer_.size() - end);
    if (got > 0) {
      view_ = {view_.data(), view_.size() + static_cast<std::size_t>(got)};
      continue;
    }
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fault_ = SystemFault(path_, "read");
    ::close(std::exchange(descriptor_, -1));
  }
  return view_.size() >= size;
}

}  // namespace wellgyro
