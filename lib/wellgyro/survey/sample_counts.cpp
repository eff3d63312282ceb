#include "wellgyro/survey/sample_counts.h"

#include <algorithm>

namespace wellgyro {

void CountSamples(const SampleStamp& stamp, std::int64_t samples, RunSummary& summary) {
  RunSummary& s = summary;
  s.temperature_min =
      s.samples == 0 ? stamp.temperature : std::min(s.temperature_min, stamp.temperature);
  s.temperature_max =
      s.samples == 0 ? stamp.temperature : std::max(s.temperature_max, stamp.temperature);
  s.samples += samples;
  s.samples_gyro_saturated += samples * stamp.gyro_saturated;
  s.samples_accel_saturated += samples * stamp.accel_saturated;
  s.samples_unsynced += samples * stamp.utc_unsynced;
  s.samples_temperature_outside += samples * stamp.temperature_outside;
}

}  // namespace wellgyro
