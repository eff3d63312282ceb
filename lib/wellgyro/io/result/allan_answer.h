#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/noise/noise_fit.h"
#include "wellgyro/noise/sample_series.h"

namespace wellgyro {

/// What is asked of a static log.
struct AllanRequest {
  enum class Taus { kOctave, kDecade, kList };

  Deviation deviation = Deviation::kOverlapped;
  Taus taus = Taus::kOctave;
  std::vector<double> tau_list;  ///< [s], with kList
  std::string unit;              ///< see AllanUnits; empty: the series' own, else rad_per_s
  double scale = 1;              ///< the values times this are in `unit`; counts: in rad/s
  bool unitless = false;         ///< plain numbers: the table only
  bool phases = false;           ///< the values are phases, not rates
  std::vector<std::pair<double, double>> exclude;  ///< stretches to leave out [s from the first]
  bool robust = false;                             ///< leave out spikes
  bool detrend_temperature = false;                ///< take off what follows the temperature
  NoiseFitOptions fit;
  std::string source;  ///< name of the log, for the noise file and the plot
  std::string channel;
  bool plot = false;
  std::function<void(double)> progress;
};

/// deg_per_h, deg_per_s, rad_per_s, counts; for accelerometers mps2, milli_g.
WELLGYRO_EXPORT std::vector<std::string> AllanUnits();

struct AllanAnswer {
  std::string table;                 ///< CSV: tau, deviation, terms, degrees of freedom, bounds
  std::optional<std::string> noise;  ///< the noise file, when there was a fit and a unit
  std::string plot;                  ///< SVG, when asked for
  std::string summary;               ///< lines for people: what was found, with bounds
  std::vector<std::string> notes;    ///< what the log was not, and where
  std::optional<Fault> unfit;        ///< why there are no coefficients
  bool losses = false;               ///< samples missing, not finite or saturated
};

/// Analyses `series`, whose period must be set. A Fault when there is not one difference to take.
/// Throws std::invalid_argument for a request that makes no sense.
WELLGYRO_EXPORT Result<AllanAnswer> AnswerAllan(SampleSeries series, const AllanRequest& request);

}  // namespace wellgyro
