#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/noise/sample_series.h"

namespace wellgyro {

/// What is wrong with times, and at which sample.
struct TimesComplaint {
  std::string text;
  std::size_t sample = 0;
};

/// Sets the period and a place for every sample that is missing from the samples' times [s], whose
/// jitter may be a tenth of the period, 1-sigma. Gives what is wrong with them: they go back, or
/// lie between places.
WELLGYRO_EXPORT std::optional<TimesComplaint> PlaceByTime(SampleSeries& series,
                                                          std::span<const double> times);

/// Leaves out [from, to) [s from the first sample]; the period must be set. Gives the samples left
/// out.
WELLGYRO_EXPORT std::int64_t Exclude(SampleSeries& series, double from, double to);

/// Leaves out single readings beyond eight robust sigmas of the thousand about them. Where more
/// than a hundredth are, they are no spikes: nothing is left out and 0 is given.
WELLGYRO_EXPORT std::int64_t ExcludeSpikes(SampleSeries& series);

/// What a log followed of its temperature: slope and bend, least squares over means of 1/2000.
struct TemperatureTrend {
  double per_degree = 0, per_degree_sigma = 0;  ///< at the mean temperature [data's unit per degC]
  double per_degree2 = 0;                       ///< [data's unit per degC^2]
  double mean = 0;                              ///< temperature [degC]
  double explained = 0;                         ///< share of the means' variance
};

/// Takes the trend off the readings; nothing where there is no temperature or it does not vary.
WELLGYRO_EXPORT std::optional<TemperatureTrend> DetrendTemperature(SampleSeries& series);

}  // namespace wellgyro
