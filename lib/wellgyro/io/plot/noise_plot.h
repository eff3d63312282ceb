#pragma once

#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/noise/allan_confidence.h"
#include "wellgyro/noise/noise_fit.h"

namespace wellgyro {

/// How the plot is labelled. Text is escaped for XML here.
struct NoisePlotLabels {
  std::string title;
  std::string deviation;                 ///< of the vertical axis, with its unit
  double deviation_si = 1;               ///< one of that unit in SI
  PerTerm<std::string> term{};           ///< of each observable term
  std::vector<std::string> facts = {};   ///< below the title: the log's length and rate
  std::vector<std::string> bounds = {};  ///< below the legend: what the log cannot show
  std::vector<std::string> warnings =
      {};  ///< in the picture, of a log that moved, a fit that failed
};

/// The deviation against averaging time, both logarithmic, as an SVG picture: the measured points,
/// the band that holds the truth with 95 %, the fitted sum and each observable term, and what is
/// wrong with the log or its fit. `fit` may be null. Throws std::invalid_argument for no rows.
WELLGYRO_EXPORT std::string NoisePlotSvg(std::span<const AllanRow> rows, const NoiseFit* fit,
                                         const NoisePlotLabels& labels);

}  // namespace wellgyro
