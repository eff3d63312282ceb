#pragma once

#include <string>
#include <vector>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// Name of one part of a log that is rotated: of rig.lcm itself (0), rig.001.lcm, rig.002.lcm ...
WELLGYRO_EXPORT std::string LogPart(const std::string& path, int number);

/// `path` and the parts behind it that are there, up to the first that is not: as LogPart names
/// them, or, of a path like rig.lcm.00, as lcm-logger --increment does, rig.lcm.01, rig.lcm.02 ...
WELLGYRO_EXPORT std::vector<std::string> LogParts(const std::string& path);

}  // namespace wellgyro
