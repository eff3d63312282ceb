#include "wellgyro/io/atomic_file.h"

#include <cerrno>
#include <cstddef>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

namespace wellgyro {
namespace {

Fault Refused(const std::filesystem::path& path, std::string_view what, int error) {
  return {.code = FaultCode::kIo,
          .text = fmt::format("cannot {}: {}", what, std::generic_category().message(error)),
          .source = path.string()};
}

std::optional<Fault> WriteAll(int file, std::string_view bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return Refused(path, "write", errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return std::nullopt;
}

// A whole file under its temporary name, removed again unless it is put in place.
class Partial {
 public:
  explicit Partial(std::filesystem::path target) : target_(std::move(target)) {
    temporary_ = target_.parent_path() /
                 fmt::format(".{}.{}.partial", target_.filename().string(), ::getpid());
  }
  ~Partial() {
    if (file_ >= 0) ::close(file_);
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
  }
  Partial(Partial&& other) noexcept
      : target_(std::move(other.target_)),
        temporary_(std::exchange(other.temporary_, {})),
        file_(std::exchange(other.file_, -1)) {}
  Partial& operator=(Partial&&) = delete;

  std::optional<Fault> Write(std::string_view bytes) {
    file_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file_ < 0) return Refused(target_, "make a file beside it", errno);
    return WriteAll(file_, bytes, target_);
  }

  std::optional<Fault> Sync() {
    if (::fsync(file_) != 0) return Refused(target_, "write to disk", errno);
    if (::close(std::exchange(file_, -1)) != 0) return Refused(target_, "close", errno);
    return std::nullopt;
  }

  std::optional<Fault> PutInPlace() {
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
      return Refused(target_, "put the new file in place", errno);
    }
    temporary_.clear();
    return std::nullopt;
  }

 private:
  std::filesystem::path target_, temporary_;
  int file_ = -1;
};

// So that the renames themselves survive a loss of power. Some file systems know no such thing.
void SyncFolder(const std::filesystem::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

}  // namespace

std::optional<Fault> WriteFiles(const std::filesystem::path& folder,
                                std::span<const OutputFile> files) {
  // An empty folder is the one that the program runs in.
  const std::filesystem::path place = folder.empty() ? "." : folder;
  std::vector<Partial> partials;
  for (const OutputFile& file : files) {
    const std::filesystem::path target = place / file.name;
    std::error_code error;
    std::filesystem::create_directories(target.parent_path(), error);
    if (error) return Refused(target.parent_path(), "make this folder", error.value());
    partials.emplace_back(target);
    if (auto fault = partials.back().Write(file.bytes)) return fault;
  }
  // All of them are written by now: the first wait for the disk is mostly the only one.
  for (Partial& partial : partials) {
    if (auto fault = partial.Sync()) return fault;
  }
  for (Partial& partial : partials) {
    if (auto fault = partial.PutInPlace()) return fault;
  }
  std::set<std::filesystem::path> folders;
  for (const OutputFile& file : files) folders.insert((place / file.name).parent_path());
  for (const std::filesystem::path& each : folders) SyncFolder(each);
  return std::nullopt;
}

}  // namespace wellgyro
