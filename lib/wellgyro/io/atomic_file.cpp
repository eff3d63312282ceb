#include "wellgyro/io/atomic_file.h"

#include <cerrno>
#include <charconv>
#include <csignal>
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

#include "wellgyro/io/file_in_pieces.h"

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

// Where a name leads, though nothing be there yet: what is written is to be in the link's place.
std::filesystem::path Followed(std::filesystem::path name) {
  constexpr int kMostLinks = 40;  // as the system's own limit
  std::error_code error;
  for (int i = 0; i < kMostLinks && std::filesystem::is_symlink(name, error); ++i) {
    const std::filesystem::path next = std::filesystem::read_symlink(name, error);
    if (error) break;
    name = name.parent_path() / next;  // an absolute one stands alone
  }
  return name;
}

// What a killed program left of writing `target`: temporary names of processes that are no more.
void RemoveLeftovers(const std::filesystem::path& target) {
  const std::filesystem::path folder =
      target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
  const std::string start = fmt::format(".{}.", target.filename().string());
  std::error_code error;
  std::vector<std::filesystem::path> left;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (!name.starts_with(start) || !name.ends_with(".partial")) continue;
    const std::string number = name.substr(start.size(), name.size() - start.size() - 8);
    int process = 0;
    const auto [rest, wrong] =
        std::from_chars(number.data(), number.data() + number.size(), process);
    const bool whole = wrong == std::errc() && rest == number.data() + number.size();
    if (whole && process > 0 && ::kill(process, 0) != 0 && errno == ESRCH) {
      left.push_back(it->path());
    }
  }
  for (const std::filesystem::path& each : left) ::unlink(each.c_str());
}

// So that the renames themselves survive a loss of power. Some file systems know no such thing.
void SyncFolder(const std::filesystem::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

}  // namespace

// A target that is no regular file, such as a pipe, is written to as it is.
FileInPieces::FileInPieces(const std::filesystem::path& name) : target_(Followed(name)) {
  struct stat status {};
  exists_ = ::stat(target_.c_str(), &status) == 0;
  mode_ = status.st_mode;
}

FileInPieces::~FileInPieces() {
  if (file_ >= 0) ::close(file_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

FileInPieces::FileInPieces(FileInPieces&& other) noexcept
    : target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      file_(std::exchange(other.file_, -1)),
      mode_(other.mode_),
      exists_(other.exists_) {}

bool FileInPieces::direct() const { return exists_ && !S_ISREG(mode_) && !S_ISDIR(mode_); }

std::optional<Fault> FileInPieces::Open() {
  if (direct()) {
    file_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (file_ < 0) return Refused(target_, "open it to write", errno);
    return std::nullopt;
  }
  const std::filesystem::path folder = target_.parent_path();
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  if (error) return Refused(folder, "make this folder", error.value());
  if (exists_ && S_ISDIR(mode_)) return Refused(target_, "write", EISDIR);
  RemoveLeftovers(target_);
  // What may not be written may not be replaced either.
  if (exists_ && ::access(target_.c_str(), W_OK) != 0) return Refused(target_, "write", errno);
  const std::filesystem::path temporary =
      folder / fmt::format(".{}.{}.partial", target_.filename().string(), ::getpid());
  file_ = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_ < 0) return Refused(target_, "make a file beside it", errno);
  temporary_ = temporary;
  if (exists_ && ::fchmod(file_, mode_ & 07777) != 0) {
    return Refused(target_, "keep its mode", errno);
  }
  return std::nullopt;
}

std::optional<Fault> FileInPieces::Append(std::string_view bytes) {
  if (file_ < 0) {
    if (auto fault = Open()) return fault;
  }
  return WriteAll(file_, bytes, target_);
}

std::optional<Fault> FileInPieces::Sync() {
  if (!direct() && ::fsync(file_) != 0) return Refused(target_, "write to disk", errno);
  if (::close(std::exchange(file_, -1)) != 0) return Refused(target_, "close", errno);
  return std::nullopt;
}

std::optional<Fault> FileInPieces::PutInPlace() {
  if (direct()) return std::nullopt;
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
    return Refused(target_, "put the new file in place", errno);
  }
  temporary_.clear();
  return std::nullopt;
}

std::optional<Fault> FileInPieces::Finish() {
  if (auto fault = Sync()) return fault;
  if (auto fault = PutInPlace()) return fault;
  SyncFolder(target_.has_parent_path() ? target_.parent_path() : ".");
  return std::nullopt;
}

std::optional<Fault> WriteFiles(const std::filesystem::path& folder,
                                std::span<const OutputFile> files) {
  // An empty folder is the one that the program runs in.
  const std::filesystem::path place = folder.empty() ? "." : folder;
  std::vector<FileInPieces> partials;
  for (const OutputFile& file : files) {
    partials.emplace_back(place / file.name);
    if (auto fault = partials.back().Append(file.bytes)) return fault;
  }
  // All of them are written by now: the first wait for the disk is mostly the only one.
  for (FileInPieces& partial : partials) {
    if (auto fault = partial.Sync()) return fault;
  }
  for (FileInPieces& partial : partials) {
    if (auto fault = partial.PutInPlace()) return fault;
  }
  std::set<std::filesystem::path> folders;
  for (const OutputFile& file : files) folders.insert((place / file.name).parent_path());
  for (const std::filesystem::path& each : folders) SyncFolder(each);
  return std::nullopt;
}

std::optional<Fault> CannotWrite(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && std::filesystem::is_other(status)) return std::nullopt;
  return FileInPieces(path).Append({});
}

std::optional<Fault> WriteSecretFile(const std::filesystem::path& path, std::string_view bytes) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0 && errno == EEXIST) {
    return Fault{FaultCode::kConflict, "exists; choose another name", path.string()};
  }
  if (file < 0) return Refused(path, "create", errno);
  std::optional<Fault> fault = WriteAll(file, bytes, path);
  if (!fault && ::fsync(file) != 0) fault = Refused(path, "write to disk", errno);
  if (::close(file) != 0 && !fault) fault = Refused(path, "close", errno);
  if (fault) ::unlink(path.c_str());
  return fault;
}

}  // namespace wellgyro
