#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "commands.h"
#include "report.h"

namespace wellgyro::apps {

/// As it is called: "wellgyro calibrate verify".
inline std::string CallOf(const CLI::App& command) {
  const CLI::App* const parent = command.get_parent();
  return parent == nullptr ? command.get_name() : CallOf(*parent) + " " + command.get_name();
}

/// Has the command run by `run`, which gives the exit code. A request that makes no sense, as the
/// library finds it, is the caller's mistake: told, with where the help is.
template <class Run>
void OnCall(CLI::App* command, int& exit_code, Run run) {
  command->callback([command, &exit_code, run = std::move(run)] {
    try {
      exit_code = run();
    } catch (const std::invalid_argument& error) {
      exit_code = Misused(fmt::format("{}; see {} --help", error.what(), CallOf(*command)));
    }
  });
}

/// The exit code of work that is done, or that failed and is said to have.
inline int Concluded(const std::optional<Fault>& fault) { return fault ? Unusable(*fault) : kDone; }

}  // namespace wellgyro::apps
