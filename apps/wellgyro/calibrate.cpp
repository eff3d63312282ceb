#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/tool_update.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/sensor/bench_data.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/toml/calibration_file.h"
#include "wellgyro/io/toml/tool_file.h"

#include "bench_methods.h"
#include "bench_options.h"
#include "calibrate_tool.h"
#include "commands.h"
#include "on_call.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

/// The readings of one file, which joins the inputs; none where no file is named.
Result<BenchTable> ReadInput(const std::string& name, const std::string& role,
                             std::vector<InputFile>& inputs) {
  if (name.empty()) return BenchTable{};
  const Result<std::string> text = ReadTextFile(name);
  if (!text) return text.fault();
  inputs.push_back({role, name, name, Sha256Hex(*text)});
  return ParseBenchTable(*text, name);
}

Result<std::string> ToolText(const BenchOptions& o, const BenchCalibration& calibration) {
  ToolCalibration tool;
  if (std::filesystem::exists(o.tool)) {
    auto known = ReadToolFile(o.tool);
    if (!known) return known.fault();
    tool = *std::move(known);
  }
  return ToolToml(Updated(std::move(tool), calibration, o.update));
}

// What nobody stated is in the result all the same.
void RecordGravity(const BenchOptions& o, CalibrationFile& file) {
  if (o.gravity_stated) return;
  const double g = o.reference.gravity_mps2;
  const bool normal = g != units::kStandardGravity;
  file.references.push_back(fmt::format("gravity {:.6g} m/s2 ({}, default)", g,
                                        normal ? "normal at the latitude" : "standard"));
  if (normal) return;
  file.report.remarks.push_back(fmt::format(
      "gravity is taken for standard, {:.6g} m/s2: from equator to pole it is 9.78 to 9.83, and "
      "sensitivities are wrong by as much (--gravity-mps2, or --gravity-g)",
      g));
}

std::optional<Fault> RunMethod(BenchOptions& o, const BenchMethod& method, bool takes_gravity) {
  Complete(o);
  CalibrationFile file;
  file.program = "wellgyro " WELLGYRO_VERSION;
  file.references = o.said;
  const Result<BenchTable> data = ReadInput(o.data, "data", file.inputs);
  if (!data) return data.fault();
  const Result<BenchTable> joined = ReadInput(o.joined, method.joined_role, file.inputs);
  if (!joined) return joined.fault();
  Result<BenchOutcome> outcome = method.fit(*data, *joined, o);
  if (!outcome) return outcome.fault();
  file.report = outcome->calibration.report;
  // A fixture that says what it applies (axb, ayb, azb) stands in place of gravity.
  if (takes_gravity && !data->Find("axb")) RecordGravity(o, file);
  file.check = outcome->check;
  // What cannot be written is told before anything is.
  std::vector<OutputFile> files = {{o.out, CalibrationToml(file)}};
  if (!o.tool.empty()) {
    Result<std::string> text = ToolText(o, outcome->calibration);
    if (!text) return text.fault();
    files.push_back({o.tool, *std::move(text)});
  }
  fmt::print("{}", CalibrationSummary(file));
  return WriteAndName(files);
}

void AddMethod(CLI::App& calibrate, int& exit_code, const std::shared_ptr<BenchOptions>& o,
               const BenchMethod& method) {
  CLI::App* const command = calibrate.add_subcommand(method.name, method.help);
  command
      ->add_option("--data", o->data,
                   fmt::format("readings of the bench (CSV): {}", method.columns))
      ->required();
  command->add_option("--out", o->out, "calibration file to write (TOML)")->required();
  method.add_options(*command, *o);
  command->footer(
      fmt::format("Example:\n  wellgyro calibrate {0} --data bench.csv \\\n      --out {0}.toml{1}",
                  method.name, method.needs));
  const bool takes_gravity = command->get_option_no_throw("--gravity-g") != nullptr;
  OnCall(command, exit_code,
         [o, &method, takes_gravity] { return Concluded(RunMethod(*o, method, takes_gravity)); });
}

}  // namespace

void AddCalibrate(CLI::App& app, int& exit_code) {
  CLI::App* const command = app.add_subcommand(
      "calibrate", "Fits a calibration to bench data, with covariance and residuals");
  command->require_subcommand(1);
  command->footer(
      "Example:\n  wellgyro calibrate six-position --data bench.csv --out accel.toml \\\n"
      "      --gravity-mps2 9.8123 --tool tool.toml --channels 3,4,5");
  const auto options = std::make_shared<BenchOptions>();
  for (const BenchMethod& method : BenchMethods()) AddMethod(*command, exit_code, options, method);
  AddCalibrateTool(*command, exit_code);
  AddCalibrateVerify(*command, exit_code);
  AddCalibratePlan(*command, exit_code);
  AddCalibrateHistory(*command, exit_code);
  AddCalibrateLearn(*command, exit_code);
}

}  // namespace wellgyro::apps
