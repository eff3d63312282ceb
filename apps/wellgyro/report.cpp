#include "report.h"

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <stop_token>

#include <fmt/core.h>
#include <unistd.h>

#include "wellgyro/live/notices.h"

#include "commands.h"

namespace wellgyro::apps {
namespace {

std::int64_t NowMs() {
  using std::chrono::duration_cast, std::chrono::milliseconds, std::chrono::steady_clock;
  return duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count();
}

}  // namespace

std::string Printable(std::string_view text) { return wellgyro::Printable(text); }

void Complain(std::string_view sentence) { fmt::print(stderr, "wellgyro: {}\n", sentence); }

void Complain(const Fault& fault) { Complain(SentenceOf(fault)); }

int Unusable(std::string_view sentence) {
  Complain(sentence);
  return kUnusable;
}

int Unusable(const Fault& fault) { return Unusable(SentenceOf(fault)); }

int Misused(std::string_view sentence) {
  Complain(sentence);
  return kUsage;
}

int Misused(const Fault& fault) { return Misused(SentenceOf(fault)); }

Progress::Progress(std::string_view doing, bool shown)
    : doing_(doing),
      terminal_(shown && isatty(STDERR_FILENO) != 0),
      begin_ms_(NowMs()),
      last_ms_(0) {}

Progress::~Progress() {
  if (shown_) fmt::print(stderr, "\r{:{}}\r", "", doing_.size() + 8);
}

void Progress::Show(std::int64_t done, std::int64_t all) {
  if (!terminal_ || all <= 0) return;
  const std::int64_t now = NowMs();
  if (now - begin_ms_ < 1000 || now - last_ms_ < 100) return;
  last_ms_ = now;
  shown_ = true;
  fmt::print(stderr, "\r{} {:3} %", doing_, 100 * done / all);
  std::fflush(stderr);
}

Waiting::Waiting(std::string_view doing, bool shown) {
  if (!shown || isatty(STDERR_FILENO) == 0) return;
  ticker_ = std::jthread([what = std::string(doing)](const std::stop_token& stop) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any ended;
    for (int seconds = 0; !stop.stop_requested(); ++seconds) {
      fmt::print(stderr, "\r{}, {} s", what, seconds);
      std::fflush(stderr);
      ended.wait_for(lock, stop, std::chrono::seconds(1), [] { return false; });
    }
    fmt::print(stderr, "\r{:{}}\r", "", what.size() + 12);
    std::fflush(stderr);
  });
}

}  // namespace wellgyro::apps
