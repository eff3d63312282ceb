#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "wellgyro/survey/survey.h"

namespace wellgyro {

/// One tool's survey, and the folder that its files go to: the one given where a single tool has a
/// survey, tool-N in it for several. A tool without a survey, which may be no more than a damaged
/// number in a message, takes no folder of its own.
struct ToolResult {
  std::int32_t tool = 0;
  std::filesystem::path folder;
  Survey survey;
};

/// What wrote the result: in run.toml.
struct Maker {
  std::string program;   ///< name and version
  std::string adjuster;  ///< of the runs
};

}  // namespace wellgyro
