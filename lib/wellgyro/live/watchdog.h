#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

#include "wellgyro/base/export.h"
#include "wellgyro/live/observer.h"

namespace wellgyro {

/// Looks after a thread that may be busy for long: calls `late` once a second while the thread has
/// not called Alive for longer than that, and `stuck`, once, when it has not ended 1.5 s after
/// somebody asked it to. Both are called from the watchdog's own thread.
class WELLGYRO_EXPORT Watchdog {
 public:
  /// Without Alive, until `late`: a status is due every second, and two looks at the clock.
  static constexpr std::int64_t kLateUs = 1'200'000;
  static constexpr std::int64_t kStuckUs = 1'500'000;  ///< from Ending, until `stuck`

  /// `clock` must outlive this object.
  Watchdog(const LiveClock& clock, std::function<void()> late, std::function<void()> stuck);
  ~Watchdog();
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  void Alive() { alive_us_ = clock_.monotonic_us(); }
  /// The thread has been asked to end. For signal handlers too.
  void Ending() noexcept { asked_ = true; }
  /// The thread is through: nothing is called any more.
  void Through();

 private:
  void Work();

  const LiveClock& clock_;
  std::function<void()> late_, stuck_;
  std::atomic<std::int64_t> alive_us_;
  std::atomic<bool> asked_ = false;
  std::mutex mutex_;
  std::condition_variable woken_;
  bool through_ = false;
  std::thread thread_;
};

}  // namespace wellgyro
