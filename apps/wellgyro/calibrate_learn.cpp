#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/calibration/lessons.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/io/toml/run_lesson_file.h"
#include "wellgyro/io/toml/tool_file.h"

#include "calibrate_tool.h"
#include "commands.h"
#include "on_call.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct LearnOptions {
  std::vector<std::string> runs;
  std::string out;
};

Result<RunLessons> LessonsOf(std::filesystem::path path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) path /= "run.toml";
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  return ParseRunLessons(*text, path.string());
}

std::optional<Fault> Learn(const LearnOptions& o) {
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
    if (!all) {
      all = *std::move(one);
    } else {
      all->lessons.insert(all->lessons.end(), one->lessons.begin(), one->lessons.end());
    }
  }
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
