#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "wellgyro/base/result.h"

namespace wellgyro::apps {

// Subcommands of calibrate: the joint adjustment; then what is done with calibrations.
void AddCalibrateTool(CLI::App& calibrate, int& exit_code);
void AddCalibrateVerify(CLI::App& calibrate, int& exit_code);
void AddCalibratePlan(CLI::App& calibrate, int& exit_code);
void AddCalibrateLearn(CLI::App& calibrate, int& exit_code);
void AddCalibrateHistory(CLI::App& calibrate, int& exit_code);

// Writes a whole file and prints its name.
std::optional<Fault> WriteAndName(const std::filesystem::path& path, const std::string& bytes);

}  // namespace wellgyro::apps
