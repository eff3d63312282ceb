#include <CLI/CLI.hpp>

#include "commands.h"

int main(int argc, char** argv) {
  CLI::App app{"wellgyro: from a gyro survey tool's sensor stream to a wellbore survey"};
  app.set_version_flag("--version", "wellgyro 0.1.0");
  app.require_subcommand(1);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? wellgyro::apps::kDone : wellgyro::apps::kUsage;
  }
  return wellgyro::apps::kDone;
}
