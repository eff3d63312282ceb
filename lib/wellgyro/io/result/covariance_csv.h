#pragma once

#include <span>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/hole/well_uncertainty.h"
#include "wellgyro/survey/wells/separation.h"

/// Position uncertainty as plain CSV: one header line, UTF-8, LF, a dot for decimals. Lengths to
/// 1e-4, angles to 1e-6, covariances to 9 significant digits.
namespace wellgyro {

/// covariance.csv: per station the covariance of north, east, vertical and that of high side,
/// lateral, along hole, 1 sigma, and the horizontal ellipse at `confidence`. As many rows as there
/// are covariances. Throws std::domain_error for a confidence outside (0, 1).
WELLGYRO_EXPORT std::string CovarianceCsv(const SurveyedWell& well,
                                          const PositionUncertainty& errors, double confidence);

/// terms.csv: MD[m],TERM and the six columns of north, east, vertical, for every term at every
/// station.
WELLGYRO_EXPORT std::string TermsCsv(const SurveyedWell& well, const PositionUncertainty& errors);

/// "station", "nearest" or "lowest".
WELLGYRO_EXPORT std::string_view KindWord(Separation::Kind kind);

/// separation.csv: MD[m],OTHER_MD[m],DISTANCE[m],N[m],E[m],V[m],SIGMA[m],SIGMAS,KIND; SIGMAS is
/// empty where sigma is zero.
WELLGYRO_EXPORT std::string SeparationCsv(std::span<const Separation> separations);

}  // namespace wellgyro
