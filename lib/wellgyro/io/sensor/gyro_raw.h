#pragma once

#include <filesystem>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/survey_table.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// The G7 records of an IOGP P7/17 file as averages at rest, for a Surveyor: another vendor's
/// stations, solved afresh.
///
/// A record says neither how long it rested nor how well: alignment.min_still of the job and its
/// noise coefficients are taken, 0.01 deg/h and 1e-4 m/s^2 at least. Gravity or specific force,
/// whichever agrees with the file's own inclinations; where both do, all records being horizontal,
/// the one along which the Earth turns as at the job's latitude. Records without a time follow each
/// other by a minute. Records marked unused are left out; a third axis that is zero throughout is
/// none. Faults: kLost without a usable record, kConflict where the accelerometers give other
/// inclinations than the file by more than 2 deg (its axes are not x and y across, z down-hole), or
/// where both signs agree and the Earth's rate does not tell them apart, as at less than 8 deg of
/// latitude.
WELLGYRO_EXPORT Result<std::vector<StillWindow>> WindowsOfGyroRaw(const SurveyTable& table,
                                                                  const Job& job);

/// True where the file begins as an IOGP file.
WELLGYRO_EXPORT bool IsIogpFile(const std::filesystem::path& path);

}  // namespace wellgyro
