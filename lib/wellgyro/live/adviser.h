#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <thread>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/estimate/run_state.h"
#include "wellgyro/plan/live_advice.h"
#include "wellgyro/record/advice.h"
#include "wellgyro/survey/run/run_now.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// Thinks about what a run had best do in a thread of its own, from a copy of what is known: the
/// survey neither waits for it nor is changed by it.
class WELLGYRO_EXPORT Adviser {
 public:
  explicit Adviser(const AdviceCase& advised);
  ~Adviser();
  Adviser(const Adviser&) = delete;
  Adviser& operator=(const Adviser&) = delete;

  /// To be called again and again: what it has come to since. Every two seconds, where nothing is
  /// being thought about, it asks anew, of the tool that was heard of first by its number.
  /// `now_us`: of a monotonic clock.
  std::optional<Advice> Attend(const Surveyor& surveyor, std::int64_t now_us);

 private:
  /// False: something is being thought about. `newest`: begin of the newest sample.
  bool Ask(const RunNow& now, UtcTime newest);
  std::optional<Advice> Take();
  void Work();
  Advice Answer() const;

  const AdviceCase case_;
  std::int64_t next_us_ = 0;  ///< when it asks again
  std::mutex mutex_;
  std::condition_variable changed_;
  bool busy_ = false;  ///< what follows belongs to the thread
  bool ending_ = false;
  RunNow now_;
  RunState state_;
  UtcTime newest_;
  double deepest_ = 0;  ///< so far, of the present run [m]
  std::optional<Advice> advice_;
  std::thread thread_;
};

}  // namespace wellgyro
