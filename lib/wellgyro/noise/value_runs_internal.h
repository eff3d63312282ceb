#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "wellgyro/noise/static_log.h"

namespace wellgyro {

/// Joins the findings, of which there are at most a hundred of each kind.
void AddFinding(const LogFinding& finding, std::vector<LogFinding>& findings);

/// Runs of one value: a constant log, which then is the only finding, piles at an end of the range,
/// readings that stood still. Saturated runs nearer to each other than `together` samples are one
/// finding.
std::vector<LogFinding> FindValueRuns(std::span<const double> rate, std::span<const SampleGap> gaps,
                                      const StaticLogOptions& options, std::int64_t together);

}  // namespace wellgyro
