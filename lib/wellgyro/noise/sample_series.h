#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/noise/allan_variance.h"

namespace wellgyro {

/// Missing samples between two neighbours, at most: 11 days at 1 kHz, at a place of 8 bytes each
/// 8 GB. A sample number further on is damage. Sums of 9e9 such gaps stay inside an int64.
inline constexpr std::int64_t kGapSamplesMost = 1'000'000'000;

/// One channel of a log, evenly sampled, a place for every sample, missing ones too.
struct SampleSeries {
  std::vector<double> values;
  std::vector<SampleGap> gaps;       ///< whatever stands in their places
  std::vector<float> temperature;    ///< of every sample [degC]; empty where not recorded
  std::vector<SampleGap> saturated;  ///< as the source says
  double period = 0;                 ///< between samples [s]; 0 where the source does not say
  std::optional<double> lowest;      ///< the converter's ends, where known
  std::optional<double> highest;
  std::string unit;                ///< rad_per_s, mps2, counts ...; empty where not said
  std::vector<std::string> notes;  ///< what the reader did or left out
  bool damaged = false;            ///< bytes or messages were lost
};

/// Phases x[0] .. x[M] into the M mean rates between them.
WELLGYRO_EXPORT void RatesFromPhases(SampleSeries& series);

}  // namespace wellgyro
