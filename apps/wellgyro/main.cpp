#include <cmath>
#include <exception>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "wellgyro/fit/solver_log.h"

#include "commands.h"
#include "help.h"
#include "live_commands.h"
#include "on_call.h"
#include "report.h"
#include "version.h"

namespace wellgyro::apps {
namespace {

/// No option of any command takes "nan" or "inf" for a number, which ranges let through.
void WantFiniteNumbers(CLI::App& command) {
  for (CLI::Option* const option : command.get_options()) {
    if (!option->get_type_name().starts_with("FLOAT")) continue;
    option->check(
        [](const std::string& text) {
          double number = 0;
          const bool bad = CLI::detail::lexical_cast(text, number) && !std::isfinite(number);
          return bad ? text + " is not a finite number" : std::string();
        },
        "");
  }
  for (CLI::App* const sub : command.get_subcommands(nullptr)) WantFiniteNumbers(*sub);
}

void AddCommands(CLI::App& app, int& exit_code) {
  AddSurvey(app, exit_code);
  AddRecord(app, exit_code);
  AddWatch(app, exit_code);
  AddSend(app, exit_code);
  AddBridge(app, exit_code);
  AddSimulate(app, exit_code);
  AddAllan(app, exit_code);
  AddCalibrate(app, exit_code);
  AddUncertainty(app, exit_code);
  AddClearance(app, exit_code);
  AddCompare(app, exit_code);
  AddMerge(app, exit_code);
  AddPlan(app, exit_code);
  AddModels(app, exit_code);
  AddNorth(app, exit_code);
  AddConvert(app, exit_code);
  AddCheck(app, exit_code);
  AddReport(app, exit_code);
}

int Run(int argc, char** argv) {
  CLI::App app{"From a gyro survey tool's sensor stream to a wellbore survey", "wellgyro"};
  app.formatter(std::make_shared<HelpText>());
  app.set_version_flag("--version", kVersionText);
  app.require_subcommand(1);
  int exit_code = kDone;
  AddCommands(app, exit_code);
  WantFiniteNumbers(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool asked = error.get_exit_code() == 0;  // --help, --version
    const std::string stray = asked ? StrayCommand(app) : Complaint(app, error);
    if (asked && stray.empty()) return app.exit(error), kDone;
    Complain(stray);
    fmt::print(stderr, "{} --help says what there is\n", CallOf(NamedCommand(app)));
    return kUsage;
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
