#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/calibration/history.h"
#include "wellgyro/io/result/certificate.h"
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

// Of one calibration no change is known: the cells of changes are empty.
void TellHistory(const ToolHistory& history) {
  for (const SourceHistory& source : history.sources) {
    const SourceUnit unit = UnitOfSource(source.name);
    const auto cell = [&](std::optional<double> si) {
      return si ? fmt::format("{:.4g}", *si * unit.per_si) : std::string();
    };
    const bool changed = !source.changes.empty();
    const auto known = [&](double si) { return changed ? std::optional(si) : std::nullopt; };
    std::string remark = changed ? "" : "one calibration: no change is known";
    if (source.shifted) remark = "shifted";
    if (source.out_of_family) remark += " out of family";
    fmt::print("{},{},{},{},{},{},{},{},{}\n", Printable(history.asset_serial), source.name,
               unit.name, history.days.size() + 1, cell(known(changed ? source.changes.back() : 0)),
               cell(known(changed ? source.sigmas.back() : 0)),
               cell(known(source.walk_per_sqrt_day)), cell(source.prior_sigma), remark);
  }
}

// Outside its range a calibration is taken as at the end of it.
void TellBeyond(const std::string& name, const ToolCalibration& tool, double temperature) {
  for (const SensorGroup* group : {&tool.gyro, &tool.accel}) {
    const bool varies = group->n_channels > 0 && group->thermometer >= 0;
    if (!varies || (temperature >= group->min && temperature <= group->max)) continue;
    Complain(fmt::format(
        "{}: calibrated from {:.4g} to {:.4g} degC: at {:.4g} degC what it is there is not known, "
        "and the nearer end stands for it (--temperature-degc)",
        name, group->min, group->max, temperature));
    return;
  }
}

// Ranges of the options are checked before: what is refused is in the files.
Result<std::vector<ToolHistory>> HistoriesIn(const HistoryOptions& o) {
  std::vector<ToolCalibration> calibrations;
  for (const std::string& name : o.tools) {
    auto tool = ReadToolFile(name);
    if (!tool) return tool.fault();
    TellBeyond(name, *tool, o.setup.temperature);
    calibrations.push_back(*std::move(tool));
  }
  try {
    return HistoriesOf(calibrations, o.setup);
  } catch (const std::invalid_argument& error) {
    return Fault{.code = FaultCode::kConflict, .text = error.what()};
  }
}

int History(const HistoryOptions& o) {
  const auto histories = HistoriesIn(o);
  if (!histories) return Unusable(histories.fault());
  fmt::print(
      "tool,source,unit,calibrations,last_change[unit],sigma[unit],walk[unit/sqrt(day)],"
      "prior_sigma[unit],remark\n");
  for (const ToolHistory& history : *histories) TellHistory(history);
  const auto changed = static_cast<std::size_t>(std::ranges::count_if(
      *histories, [](const ToolHistory& history) { return !history.days.empty(); }));
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
      "Example:\n  wellgyro calibrate history --tool 2026-01.toml --tool 2026-07.toml \\\n"
      "      --temperature-degc 90");
  OnCall(command, exit_code, [o] { return History(*o); });
}

}  // namespace wellgyro::apps
