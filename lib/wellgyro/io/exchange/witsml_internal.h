#pragma once

#include <array>
#include <string_view>

#include "wellgyro/io/exchange/columns_internal.h"

namespace wellgyro {

/// What a station's elements hold, by WITSML 1.4 names in the order of the schemas, which is the
/// same in 1.4.1.1 and 2. Before and after some of them stand others that are not single numbers.
inline constexpr std::array kWitsmlElements{
    NamedColumn{"tvd", Column::kTvd},
    NamedColumn{"incl", Column::kInclination},
    NamedColumn{"azi", Column::kAzimuth},
    NamedColumn{"mtf", Column::kMagneticToolface},
    NamedColumn{"gtf", Column::kToolface},
    NamedColumn{"dispNs", Column::kNorth},
    NamedColumn{"dispEw", Column::kEast},
    NamedColumn{"vertSect", Column::kVerticalSection},
    NamedColumn{"dls", Column::kDogleg},
    NamedColumn{"rateTurn", Column::kTurn},
    NamedColumn{"rateBuild", Column::kBuild},
    NamedColumn{"gravTotalFieldReference", Column::kGravityRef},
};
inline constexpr std::array kWitsmlMatrix{
    NamedColumn{"varianceNN", Column::kVarNN},    NamedColumn{"varianceNE", Column::kCovNE},
    NamedColumn{"varianceNVert", Column::kCovNV}, NamedColumn{"varianceEE", Column::kVarEE},
    NamedColumn{"varianceEVert", Column::kCovEV}, NamedColumn{"varianceVertVert", Column::kVarVV},
    NamedColumn{"biasN", Column::kBiasN},         NamedColumn{"biasE", Column::kBiasE},
    NamedColumn{"biasVert", Column::kBiasV},
};

/// Names of our own extensions: this, then the name of the column in CSV or of the head's key.
inline constexpr std::string_view kExtension = "wellgyro_";

}  // namespace wellgyro
