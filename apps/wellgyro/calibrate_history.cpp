#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/calibration/history.h"
#include "wellgyro/io/toml/tool_file.h"
#include "wellgyro/io/words.h"

#include "bench_options.h"
#include "calibrate_tool.h"
#include "commands.h"
#include "on_call.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct HistoryOptions {
  std::vector<std::string> tools;
  HistorySetup setup;
};

void TellHistory(const ToolHistory& history) {
  for (const SourceHistory& source : history.sources) {
    const double change = source.changes.empty() ? 0 : source.changes.back();
    const double sigma = source.sigmas.empty() ? 0 : source.sigmas.back();
    fmt::print("{},{},{},{:.4g},{:.4g},{:.4g},{:.4g},{}{}\n", Printable(history.asset_serial),
               source.name, history.days.size() + 1, change, sigma, source.walk_per_sqrt_day,
               source.prior_sigma, source.shifted ? "shifted" : "",
               source.out_of_family ? " out of family" : "");
  }
}

int History(const HistoryOptions& o) {
  std::vector<ToolCalibration> calibrations;
  for (const std::string& name : o.tools) {
    auto tool = ReadToolFile(name);
    if (!tool) return Unusable(tool.fault());
    calibrations.push_back(*std::move(tool));
  }
  fmt::print("tool,source,calibrations,last_change,sigma,walk_per_sqrt_day,prior_sigma,remark\n");
  const std::vector<ToolHistory> histories = HistoriesOf(calibrations, o.setup);
  for (const ToolHistory& history : histories) TellHistory(history);
  const auto changed = static_cast<std::size_t>(std::ranges::count_if(
      histories, [](const ToolHistory& history) { return !history.days.empty(); }));
  if (changed < kToolsOfFamily) {
    Complain(
        fmt::format("{} with two calibrations and more: that one is out of family is said of "
                    "{} and more",
                    Counted(changed, "tool"), kToolsOfFamily));
  }
  return kDone;
}

}  // namespace

void AddCalibrateHistory(CLI::App& calibrate, int& exit_code) {
  const auto o = std::make_shared<HistoryOptions>();
  CLI::App* const command = calibrate.add_subcommand(
      "history", "drift between calibrations, priors for the next job, tools out of family");
  command->add_option("--tool", o->tools, "tool files with dates and serials, of one tool or more")
      ->required();
  command->add_option("--temperature-degc", o->setup.temperature, "to compare at, default 20")
      ->check(Within(-60, 350));
  command->add_option("--days-ahead", o->setup.days_ahead, "of the job, default 30")
      ->check(Within(0, 10'000));
  command->footer(
      "Example:\n  wellgyro calibrate history --tool 2026-01.toml --tool 2026-07.toml "
      "--temperature-degc 90");
  OnCall(command, exit_code, [o] { return History(*o); });
}

}  // namespace wellgyro::apps
