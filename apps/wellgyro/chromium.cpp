#include "chromium.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "wellgyro/io/atomic_file.h"

namespace wellgyro::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::array kNames = {"chromium", "chromium-browser", "google-chrome", "chrome"};
constexpr std::chrono::seconds kDrawPatience(60);

std::string FindChromium() {
  const char* const path = std::getenv("PATH");
  std::string_view rest = path ? path : "";
  while (!rest.empty()) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    rest.remove_prefix(std::min(rest.size(), folder.size() + 1));
    for (const char* name : kNames) {
      const fs::path program = fs::path(folder) / name;
      if (access(program.c_str(), X_OK) == 0) return program.string();
    }
  }
  return {};
}

/// "file:///home/%7Ea/r.html".
std::string UrlOf(const fs::path& file) {
  std::string url = "file://";
  for (const char c : fs::absolute(file).string()) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '/' || c == '-' || c == '_' || c == '.';
    url += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return url;
}

/// A folder that is gone when its owner is.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "wellgyro-XXXXXX").string();
    if (mkdtemp(name.data())) path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Runs a command without input and output; whether it ended well in time.
bool RunQuietly(std::vector<std::string> command) {
  std::vector<char*> arguments;
  for (std::string& argument : command) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  }
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // A group of its own, so that what it starts ends with it.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t child = 0;
  const int failed =
      posix_spawn(&child, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return false;
  const auto end = std::chrono::steady_clock::now() + kDrawPatience;
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) {
      kill(-child, SIGKILL);
      waitpid(child, &status, 0);
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

std::optional<std::string> CannotPrint(const fs::path& pdf) {
  if (FindChromium().empty()) {
    return fmt::format("{}: no Chromium in PATH (Debian: chromium) to print it by", pdf.string());
  }
  if (const auto fault = CannotWrite(pdf)) return fmt::format("{}: {}", pdf.string(), fault->text);
  return std::nullopt;
}

std::optional<std::string> PrintByChromium(const fs::path& html, const fs::path& pdf) {
  const std::string program = FindChromium();
  if (program.empty()) {
    return fmt::format("no Chromium in PATH (Debian: chromium); print {} from any browser",
                       html.string());
  }
  const ScratchFolder profile;
  if (profile.path().empty()) return "no temporary folder can be made";
  const fs::path printed = profile.path() / "printed.pdf";
  std::vector<std::string> command = {program,
                                      "--headless",
                                      "--disable-gpu",
                                      "--no-first-run",
                                      "--disable-extensions",
                                      "--no-pdf-header-footer",
                                      "--user-data-dir=" + (profile.path() / "profile").string(),
                                      "--print-to-pdf=" + printed.string(),
                                      UrlOf(html)};
  // Its sandbox refuses to run as root.
  if (geteuid() == 0) command.insert(command.begin() + 1, "--no-sandbox");
  std::error_code failed;
  if (!RunQuietly(command) || !fs::exists(printed, failed)) {
    return fmt::format("{} did not print {}", program, html.string());
  }
  fs::copy_file(printed, pdf, fs::copy_options::overwrite_existing, failed);
  if (failed) return fmt::format("{}: {}", pdf.string(), failed.message());
  return std::nullopt;
}

}  // namespace wellgyro::apps
