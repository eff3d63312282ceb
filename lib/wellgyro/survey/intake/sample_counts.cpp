#include "wellgyro/survey/intake/sample_counts.h"

#include <cmath>

namespace wellgyro {

void CountSamples(const SampleStamp& stamp, std::int64_t samples, RunSummary& summary) {
  RunSummary& s = summary;
  // Readings that are no number leave the range as it is.
  const float T = stamp.temperature;
  const bool none = std::isnan(s.temperature_min) || s.samples == 0;
  if (none || T < s.temperature_min) s.temperature_min = T;
  if (none || T > s.temperature_max) s.temperature_max = T;
  s.samples += samples;
  s.samples_gyro_saturated += samples * stamp.gyro_saturated;
  s.samples_accel_saturated += samples * stamp.accel_saturated;
  s.samples_unsynced += samples * stamp.utc_unsynced;
  s.samples_temperature_outside += samples * stamp.temperature_outside;
}

}  // namespace wellgyro
