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

namespace wellgyro {

/// Thinks about what a run had best do in a thread of its own, from a copy of what is known: the
/// survey neither waits for it nor is changed by it.
class WELLGYRO_EXPORT Adviser {
 public:
  explicit Adviser(const AdviceCase& advised);
  ~Adviser();
  Adviser(const Adviser&) = delete;
  Adviser& operator=(const Adviser&) = delete;

  /// Asks, where nothing is being thought about; false: it is. `newest`: begin of the newest
  /// sample.
  bool Ask(const RunNow& now, UtcTime newest);
  /// What it has come to since it was taken last.
  std::optional<Advice> Take();

 private:
  void Work();
  Advice Answer() const;

  const AdviceCase case_;
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
