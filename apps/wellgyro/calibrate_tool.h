#pragma once

#include <CLI/CLI.hpp>

namespace wellgyro::apps {

// Subcommands of calibrate: the joint adjustment; then what is done with calibrations.
void AddCalibrateTool(CLI::App& calibrate, int& exit_code);
void AddCalibrateVerify(CLI::App& calibrate, int& exit_code);
void AddCalibratePlan(CLI::App& calibrate, int& exit_code);
void AddCalibrateHistory(CLI::App& calibrate, int& exit_code);

}  // namespace wellgyro::apps
