#pragma once

#include <CLI/CLI.hpp>

namespace wellgyro::apps {

/// What the program tells its caller.
enum ExitCode {
  kDone = 0,
  kUsage = 1,           ///< the command line is wrong
  kUnusable = 2,        ///< nothing usable, or a named file is not
  kDoneWithLosses = 3,  ///< done, but damage, losses or values out of range were met
  kUnfit = 4,           ///< done, and the verdict is fail: not to be handed over as it is
};

// One function a command: adds the subcommand with its options to `app`; when it is the one that
// was given, its callback runs it and puts the exit code into `exit_code`.
void AddSurvey(CLI::App& app, int& exit_code);
void AddRecord(CLI::App& app, int& exit_code);
void AddSimulate(CLI::App& app, int& exit_code);
void AddAllan(CLI::App& app, int& exit_code);
void AddCalibrate(CLI::App& app, int& exit_code);
void AddUncertainty(CLI::App& app, int& exit_code);
void AddClearance(CLI::App& app, int& exit_code);
void AddCompare(CLI::App& app, int& exit_code);
void AddMerge(CLI::App& app, int& exit_code);
void AddPlan(CLI::App& app, int& exit_code);
void AddModels(CLI::App& app, int& exit_code);
void AddNorth(CLI::App& app, int& exit_code);
void AddConvert(CLI::App& app, int& exit_code);
void AddCheck(CLI::App& app, int& exit_code);
void AddReport(CLI::App& app, int& exit_code);

}  // namespace wellgyro::apps
