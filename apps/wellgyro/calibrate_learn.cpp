#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/calibration/lessons.h"
#include "wellgyro/calibration/prior.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/io/toml/run_lesson_file.h"
#include "wellgyro/io/toml/tool_file.h"

#include "calibrate_tool.h"
#include "commands.h"
#include "distinct.h"
#include "on_call.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct LearnOptions {
  std::vector<std::string> runs;
  std::string out;
};

namespace fs = std::filesystem;

fs::path FileOf(const fs::path& run) {
  std::error_code ignored;
  return fs::is_directory(run, ignored) ? run / "run.toml" : run;
}

Result<RunLessons> LessonsOf(const fs::path& run) {
  const fs::path path = FileOf(run);
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  return ParseRunLessons(*text, path.string());
}

// A run teaches once: samples that the tool file or another run named rest on already.
std::optional<Fault> Again(const RunLessons& one, const ToolCalibration& tool,
                           const std::string& name) {
  for (const std::string& readings : one.readings) {
    if (!RestsOn(tool, readings)) continue;
    return Fault{.code = FaultCode::kConflict,
                 .text = RestsOn(one.tool, readings)
                             ? "its tool file has learnt from the same samples before"
                             : "its samples are those of another run named: each counts once",
                 .source = name};
  }
  return std::nullopt;
}

// Throws std::invalid_argument where `out` would take the place of a result's file or of the tool
// file that the runs used.
void RequireNoInput(const LearnOptions& o, const std::string& tool_sha256) {
  std::vector<fs::path> inputs;
  for (const std::string& name : o.runs) inputs.push_back(FileOf(name));
  const fs::path out = o.out;
  RequireUnread(inputs, out);
  const OutputFile file{out.filename().string(), {}};
  RequireNoSurvey(out.has_parent_path() ? out.parent_path() : ".", {&file, 1});
  std::error_code ignored;
  if (!fs::is_regular_file(out, ignored)) return;
  const auto before = ReadTextFile(out);
  if (!before || Sha256Hex(*before) != tool_sha256) return;
  throw std::invalid_argument(fmt::format(
      "{} is the tool file that the runs used, which would be lost: choose another --out", o.out));
}

Result<RunLessons> AllLessons(const LearnOptions& o) {
  std::optional<RunLessons> all;
  for (const std::string& name : o.runs) {
    auto one = LessonsOf(name);
    if (!one) return one.fault();
    if (all && one->tool_sha256 != all->tool_sha256) {
      return Fault{.code = FaultCode::kConflict,
                   .text =
                       "its tool file is another than the first run's: learn from each tool "
                       "file's runs by themselves",
                   .source = name};
    }
    if (auto fault = Again(*one, all ? all->tool : one->tool, name)) return *std::move(fault);
    if (!all) {
      all = *one;
    } else {
      all->lessons.insert(all->lessons.end(), one->lessons.begin(), one->lessons.end());
    }
    auto& rests_on = all->tool.rests_on;
    rests_on.insert(rests_on.end(), one->readings.begin(), one->readings.end());
  }
  return *std::move(all);
}

std::optional<Fault> Learn(const LearnOptions& o) {
  const auto all = AllLessons(o);
  if (!all) return all.fault();
  RequireNoInput(o, all->tool_sha256);
  ToolCalibration tool = Taught(all->tool, all->lessons);
  tool.note += fmt::format("{}with what runs found ({})", tool.note.empty() ? "" : ", ",
                           all->lessons.size());
  fmt::print("runs that taught: {}\n", all->lessons.size());
  return WriteAndName(o.out, ToolToml(tool));
}

}  // namespace

void AddCalibrateLearn(CLI::App& calibrate, int& exit_code) {
  const auto o = std::make_shared<LearnOptions>();
  CLI::App* const command = calibrate.add_subcommand(
      "learn", "what runs found of their tool's errors, into its tool file: the next job's prior");
  command
      ->add_option("--run", o->runs,
                   "a result's folder or its run.toml, repeat it for more; all of one tool file")
      ->required();
  command->add_option("--out", o->out, "tool file to write (TOML)")->required();
  command->footer(
      "Example:\n  wellgyro calibrate learn --run result-1 --run result-2 --out tool-2.toml");
  OnCall(command, exit_code, [o] { return Concluded(Learn(*o)); });
}

}  // namespace wellgyro::apps
