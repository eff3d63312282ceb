#pragma once

#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/survey/wells/empirical_model.h"

namespace wellgyro {

/// What came of surveys of the same holes: model.toml (error_model_file.h), beside each magnitude
/// what was assumed and its interval; estimates.csv (TERM,WEIGHT,PROPAGATION,UNIT,ASSUMED,
/// MAGNITUDE,LOWER95,UPPER95,KEPT; the last row `LOCAL` is what no term speaks of); holes.csv
/// (HOLE,SURVEYS,PLACES,FREEDOM,CHI_SQUARE, over its freedom). A Fault as WriteErrorModel's.
WELLGYRO_EXPORT Result<std::vector<OutputFile>> EmpiricalFiles(const EmpiricalModel& made);

}  // namespace wellgyro
