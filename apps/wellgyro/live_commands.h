#pragma once

#include <CLI/CLI.hpp>

namespace wellgyro::apps {

// The commands that speak with a running survey, as those of commands.h.
void AddWatch(CLI::App& app, int& exit_code);
void AddSend(CLI::App& app, int& exit_code);
void AddBridge(CLI::App& app, int& exit_code);

}  // namespace wellgyro::apps
