#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <CLI/CLI.hpp>

#include "wellgyro/base/result.h"
#include "wellgyro/io/atomic_file.h"

namespace wellgyro::apps {

// Subcommands of calibrate: the joint adjustment; then what is done with calibrations.
void AddCalibrateTool(CLI::App& calibrate, int& exit_code);
void AddCalibrateVerify(CLI::App& calibrate, int& exit_code);
void AddCalibratePlan(CLI::App& calibrate, int& exit_code);
void AddCalibrateLearn(CLI::App& calibrate, int& exit_code);
void AddCalibrateHistory(CLI::App& calibrate, int& exit_code);

// Writes a whole file and prints its name.
std::optional<Fault> WriteAndName(const std::filesystem::path& path, const std::string& bytes);
// Writes files, named by their paths, all or none where one cannot be made; prints their names.
std::optional<Fault> WriteAndName(std::span<const OutputFile> files);

}  // namespace wellgyro::apps
