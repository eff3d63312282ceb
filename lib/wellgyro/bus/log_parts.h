#pragma once

#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

/// Name of one part of a log that is rotated: of rig.lcm itself (0), rig.001.lcm, rig.002.lcm ...
WELLGYRO_EXPORT std::string LogPart(const std::string& path, int number);

/// `path` and the parts behind it: as LogPart names them, or, of a path like rig.lcm.00, as
/// lcm-logger --increment does, rig.lcm.01, rig.lcm.02 ... Fault kLost where one is missing before
/// others that are there.
WELLGYRO_EXPORT Result<std::vector<std::string>> LogParts(const std::string& path);

/// These logs by when their first event was received, as parts that were rotated follow each other;
/// what has no event comes last.
WELLGYRO_EXPORT std::vector<std::string> InOrderOfTime(std::vector<std::string> logs);

}  // namespace wellgyro
