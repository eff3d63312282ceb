#pragma once

#include <CLI/CLI.hpp>

namespace wellgyro::apps {

/// What the program tells its caller; see the README's table.
enum ExitCode { kDone = 0, kUsage = 1, kUnusable = 2, kDoneWithLosses = 3 };

// Each command adds its subcommand with its options; when that subcommand was given, its callback
// runs it and stores the exit code.

}  // namespace wellgyro::apps
