#include "wellgyro/live/watchdog.h"

#include <chrono>
#include <optional>
#include <utility>

#include "wellgyro/live/observer.h"

namespace wellgyro {
namespace {

constexpr int kLookMs = 100;  // between looks: half of what kLateUs leaves beyond a second

}  // namespace

Watchdog::Watchdog(const LiveClock& clock, std::function<void()> late, std::function<void()> stuck)
    : clock_(clock),
      late_(std::move(late)),
      stuck_(std::move(stuck)),
      alive_us_(clock.monotonic_us()),
      thread_([this] { Work(); }) {}

Watchdog::~Watchdog() {
  Through();
  thread_.join();
}

void Watchdog::Through() {
  const std::lock_guard lock(mutex_);
  through_ = true;
  woken_.notify_one();
}

void Watchdog::Work() {
  std::optional<std::int64_t> asked_us;
  std::int64_t said_us = 0;
  std::unique_lock lock(mutex_);
  while (!through_) {
    woken_.wait_for(lock, std::chrono::milliseconds(kLookMs), [this] { return through_; });
    if (through_) return;
    const std::int64_t now = clock_.monotonic_us();
    if (asked_ && !asked_us) asked_us = now;
    // Through() waits until what is called here has returned.
    if (asked_us && now - *asked_us > kStuckUs) {
      stuck_();
      return;
    }
    if (now - alive_us_ <= kLateUs || now - said_us < kSecondUs) continue;
    said_us = now;
    late_();
  }
}

}  // namespace wellgyro
