#pragma once

#include <cstdint>

#include "wellgyro/base/export.h"
#include "wellgyro/live/intake.h"

namespace wellgyro {

/// A FINISH waits for the samples up to its instant. Where the tool is off none come, and it holds
/// once they have stayed out for five seconds.
class WELLGYRO_EXPORT FinishWait {
 public:
  /// To be asked again and again: whether FINISH was obeyed and the samples have stayed out.
  /// `now_us`: of a monotonic clock.
  bool IsOver(const Intake& intake, std::int64_t now_us);

 private:
  std::int64_t messages_ = 0, last_us_ = 0;  ///< of samples, and when the last of them came
};

}  // namespace wellgyro
