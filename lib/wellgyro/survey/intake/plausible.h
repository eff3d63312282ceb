#pragma once

#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/record/depth.h"
#include "wellgyro/record/operations.h"

namespace wellgyro {

// Whether a record that came in holds what it can hold by record/limits.h, an event by
// survey/job_keys.h: empty, or the sentence that says what is wrong with it.
WELLGYRO_EXPORT std::string WhyImplausible(const DepthMark& mark);
WELLGYRO_EXPORT std::string WhyImplausible(const ToolInfo& info);
WELLGYRO_EXPORT std::string WhyImplausible(const Command& command);
WELLGYRO_EXPORT std::string WhyImplausible(const Event& event);

}  // namespace wellgyro
