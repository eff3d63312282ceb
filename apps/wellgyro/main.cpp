#include <exception>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "wellgyro/fit/solver_log.h"

#include "commands.h"

namespace wellgyro::apps {
namespace {

int Run(int argc, char** argv) {
  CLI::App app{"wellgyro: from a gyro survey tool's sensor stream to a wellbore survey"};
  app.set_version_flag("--version", "wellgyro " WELLGYRO_VERSION);
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::help);
  int exit_code = kDone;
  AddSurvey(app, exit_code);
  AddRecord(app, exit_code);
  AddSimulate(app, exit_code);
  AddAllan(app, exit_code);
  AddCalibrate(app, exit_code);
  AddUncertainty(app, exit_code);
  AddClearance(app, exit_code);
  AddModels(app, exit_code);
  AddNorth(app, exit_code);
  AddConvert(app, exit_code);
  AddCheck(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kUsage;
  }
  return exit_code;
}

}  // namespace
}  // namespace wellgyro::apps

int main(int argc, char** argv) {
  wellgyro::QuietSolverLog();
  try {
    return wellgyro::apps::Run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "wellgyro: {}\n", error.what());
    return wellgyro::apps::kUnusable;
  }
}
