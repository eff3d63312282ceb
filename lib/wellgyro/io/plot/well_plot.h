#pragma once

#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/hole/well_uncertainty.h"
#include "wellgyro/survey/wells/separation.h"

namespace wellgyro {

/// What stands on a well's picture besides the well. Texts are escaped here.
struct WellPlotLabels {
  std::string title;
  std::vector<std::string> facts = {};  ///< below it: tool, datum, north
  const SurveyedWell* other = nullptr;  ///< drawn beside
  std::string other_name = {};
  std::optional<Separation> nearest = {};  ///< of the other: where the two are closest
};

/// Plan and vertical section of a well side by side as an SVG picture, with error ellipses at
/// `confidence` (half axes) at a choice of stations (in the section the ellipse as seen across it).
/// The section goes through the first and the last station. Scales are equal on both axes; where
/// ellipses would be too small to see they are magnified by a round factor that stands in the
/// legend. Throws std::domain_error for a confidence outside (0, 1).
WELLGYRO_EXPORT std::string WellPlotSvg(const SurveyedWell& well, const PositionUncertainty& errors,
                                        double confidence, const WellPlotLabels& labels);

}  // namespace wellgyro
