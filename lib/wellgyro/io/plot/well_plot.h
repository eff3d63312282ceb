#pragma once

#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/well_uncertainty.h"

namespace wellgyro {

/// Plan and vertical section of a well side by side as an SVG picture, with error ellipses at
/// `confidence` at a choice of stations (in the section the ellipse as seen across it). The section
/// goes through the first and the last station. Scales are equal on both axes; where ellipses would
/// be too small to see they are magnified by a round factor that stands above the picture. Throws
/// std::domain_error for a confidence outside (0, 1).
WELLGYRO_EXPORT std::string WellPlotSvg(const SurveyedWell& well, const PositionUncertainty& errors,
                                        double confidence, const std::string& title);

}  // namespace wellgyro
