#pragma once

#include <array>
#include <string_view>

#include "wellgyro/io/columns_internal.h"

namespace wellgyro {

/// What a station's elements hold, by WITSML 1.4 names in the order of the schemas, which is the
/// same in 1.4.1.1 and 2. Before and after some of them stand others that are not single numbers.
struct WitsmlElement {
  std::string_view name;
  Column column;
};
inline constexpr std::array kWitsmlElements{
    WitsmlElement{"tvd", Column::kTvd},
    WitsmlElement{"incl", Column::kInclination},
    WitsmlElement{"azi", Column::kAzimuth},
    WitsmlElement{"mtf", Column::kMagneticToolface},
    WitsmlElement{"gtf", Column::kToolface},
    WitsmlElement{"dispNs", Column::kNorth},
    WitsmlElement{"dispEw", Column::kEast},
    WitsmlElement{"vertSect", Column::kVerticalSection},
    WitsmlElement{"dls", Column::kDogleg},
    WitsmlElement{"rateTurn", Column::kTurn},
    WitsmlElement{"rateBuild", Column::kBuild},
    WitsmlElement{"gravTotalFieldReference", Column::kGravityRef},
};
inline constexpr std::array kWitsmlMatrix{
    WitsmlElement{"varianceNN", Column::kVarNN},
    WitsmlElement{"varianceNE", Column::kCovNE},
    WitsmlElement{"varianceNVert", Column::kCovNV},
    WitsmlElement{"varianceEE", Column::kVarEE},
    WitsmlElement{"varianceEVert", Column::kCovEV},
    WitsmlElement{"varianceVertVert", Column::kVarVV},
    WitsmlElement{"biasN", Column::kBiasN},
    WitsmlElement{"biasE", Column::kBiasE},
    WitsmlElement{"biasVert", Column::kBiasV},
};

/// Names of our own extensions: this, then the name of the column in CSV or of the head's key.
inline constexpr std::string_view kExtension = "wellgyro_";

}  // namespace wellgyro
