#pragma once

#include "wellgyro/io/result/json_table_internal.h"
#include "wellgyro/io/result/survey_json.h"

namespace wellgyro {

/// {name, start_stated, columns, rows}: the path of a well as a table of MD, N, E and TVD.
/// `start_stated` is false where the file gives no position: its first station is at the well head
/// then. Faults as ParseWellStations.
Result<Json> WellJson(const OtherWell& other);

}  // namespace wellgyro
