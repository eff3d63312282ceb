#include "voice.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace wellgyro::apps {
namespace {

constexpr std::size_t kHeldMax = 64 << 10;
constexpr std::chrono::seconds kLastWordPatience{1};

/// Of the terminal; two at least.
std::size_t Columns() {
  winsize size{};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? size.ws_col : 80;
}

/// Waits for who reads. Where nobody is left who could, the words are gone.
void Write(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
    if (written >= 0 || errno == EINTR) continue;
    if (errno != EAGAIN) return;
    pollfd room{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
    ::poll(&room, 1, -1);
  }
}

}  // namespace

struct Voice::State {
  void Run();
  std::string Next(std::unique_lock<std::mutex>& lock);
  bool Silent() const { return words.empty() && !line && untold == 0; }
  std::string Cleared();

  const bool terminal = ::isatty(STDERR_FILENO) != 0;
  std::size_t shown = 0;  ///< characters of the line that lives; the writing thread's own

  std::mutex mutex;
  std::condition_variable changed;
  std::string words;                ///< lines to be written
  std::optional<std::string> line;  ///< after them
  std::size_t untold = 0;           ///< lines that found no room
  bool ended = false, done = false;
};

std::string Voice::State::Cleared() {
  return shown == 0 ? std::string() : fmt::format("\r{:{}}\r", "", std::exchange(shown, 0));
}

/// What is to be written now; empty at the end.
std::string Voice::State::Next(std::unique_lock<std::mutex>& lock) {
  changed.wait(lock, [this] { return ended || !Silent(); });
  std::string text = Cleared() + std::exchange(words, {});
  if (const std::size_t lost = std::exchange(untold, 0)) {
    text += fmt::format("wellgyro: {} lines were not shown: nobody read them\n", lost);
  }
  if (line && !terminal) text += *line + '\n';
  if (line && terminal && !ended) {
    // A line that wraps could not be taken back.
    shown = std::min(line->size(), Columns() - 1);
    text += line->substr(0, shown);
  }
  line.reset();
  return text;
}

void Voice::State::Run() {
  std::unique_lock lock(mutex);
  while (!ended || !Silent() || shown > 0) {
    const std::string text = Next(lock);
    lock.unlock();
    Write(text);
    lock.lock();
  }
  done = true;
  changed.notify_all();
}

Voice::Voice() : state_(std::make_shared<State>()), thread_([state = state_] { state->Run(); }) {}

Voice::~Voice() { End(); }

bool Voice::on_terminal() const { return state_->terminal; }

void Voice::Say(std::string line) {
  const std::scoped_lock lock(state_->mutex);
  if (state_->words.size() + line.size() < kHeldMax) {
    state_->words += std::move(line) + '\n';
  } else {
    ++state_->untold;
  }
  state_->changed.notify_all();
}

void Voice::Show(std::string line) {
  const std::scoped_lock lock(state_->mutex);
  state_->line = std::move(line);
  state_->changed.notify_all();
}

void Voice::End() {
  std::call_once(ended_, [this] { Close(); });
}

void Voice::Close() {
  std::unique_lock lock(state_->mutex);
  state_->ended = true;
  state_->changed.notify_all();
  const bool done =
      state_->changed.wait_for(lock, kLastWordPatience, [this] { return state_->done; });
  lock.unlock();
  if (done) return thread_.join();
  thread_.detach();
  if (const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC); nowhere >= 0) {
    ::dup2(nowhere, STDERR_FILENO);
    ::close(nowhere);
  }
}

}  // namespace wellgyro::apps
