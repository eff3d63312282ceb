#pragma once

#include <string>

#include "wellgyro/record/depth_mark.h"
#include "wellgyro/record/operations.h"

namespace wellgyro {

// Whether a record that came in holds what it can hold by record/limits.h: empty, or the sentence
// that says what is wrong with it.
std::string WhyImplausible(const DepthMark& mark);
std::string WhyImplausible(const ToolInfo& info);
std::string WhyImplausible(const Command& command);
std::string WhyImplausible(const Event& event);

}  // namespace wellgyro
