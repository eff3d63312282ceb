#include "wellgyro/bus/file_lock.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

namespace wellgyro {

Result<FileLock> FileLock::Take(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    return Fault{FaultCode::kIo,
                 fmt::format("{}: cannot open: {}", path.string(), std::strerror(errno)),
                 path.string()};
  }
  FileLock lock(descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return lock;
  if (errno == EWOULDBLOCK) {
    return Fault{FaultCode::kConflict,
                 fmt::format("{} is in use by another wellgyro: end that one, or give another name",
                             path.string()),
                 path.string()};
  }
  return lock;  // a file system without locks keeps nobody out
}

FileLock::~FileLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

FileLock::FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

}  // namespace wellgyro
