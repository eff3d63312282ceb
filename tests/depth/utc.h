#pragma once

#include "wellgyro/base/time.h"

namespace wellgyro {

/// Some time of the runs in these tests.
inline UtcTime Utc(double seconds) {
  return {1'700'000'000'000'000'000 + Duration::Seconds(seconds).ns};
}

}  // namespace wellgyro
