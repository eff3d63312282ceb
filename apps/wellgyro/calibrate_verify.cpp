#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/fit/bench_sigmas.h"
#include "wellgyro/fit/tool_verify.h"
#include "wellgyro/io/sensor/bench_data.h"
#include "wellgyro/io/toml/tool_file.h"

#include "bench_options.h"
#include "calibrate_tool.h"
#include "commands.h"
#include "on_call.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct VerifyOptions {
  BenchOptions bench;
  VerifySetup setup;
};

std::string JudgementOf(const ToolShift& shift) {
  std::string text = shift.limit > 0 ? fmt::format(", limit {:.4g}", shift.limit) : "";
  if (shift.shifted) text += "  shifted";
  if (shift.limit > 0 && !shift.within) text += "  out of budget";
  if (!shift.told) text += "  not verified";
  return text;
}

void TellShifts(const Verification& found) {
  for (const ToolShift& shift : found.shifts) {
    if (std::isinf(shift.sigma)) {
      fmt::print("{:<12} not told from others by these positions  not verified\n", shift.name);
      continue;
    }
    fmt::print("{:<12} {:+.4g} +- {:.2g} {}{}\n", shift.name, shift.value, shift.sigma, shift.unit,
               JudgementOf(shift));
  }
}

void TellResiduals(const Verification& found) {
  fmt::print("residuals: chi-square {:.1f} of {}, as large by chance {:.2g}\n", found.chi_square,
             found.dof, found.probability);
  fmt::print("beside the shifts: chi-square {:.1f} of {}\n", found.left, found.left_dof);
  if (found.beyond) {
    fmt::print(
        "read from {:.4g} to {:.4g} degC, beyond the temperatures that the tool was calibrated "
        "at: what it is off there, the calibration does not know\n",
        found.beyond->first, found.beyond->second);
  }
  if (!found.fits) {
    fmt::print(
        "what is beside the shifts fits neither the calibration nor the bench: scale, alignment, "
        "an outlier, the latitude, or a sigma stated too small (--sigma-deg-per-h, --sigma-accel, "
        "--wobble-arcsec)\n");
  }
}

void TellOutcome(const Verification& found) {
  if (found.unassigned) {
    fmt::print(
        "the readings are not those of the calibration, and these positions do not tell which "
        "shift makes them so\n");
  }
  const char* const outcome = found.outcome == VerifyOutcome::kPass   ? "pass"
                              : found.outcome == VerifyOutcome::kFail ? "fail"
                                                                      : "not verified";
  fmt::print("{}: chance reaches {:.2f} sigmas\n", outcome, found.reach);
  if (std::ranges::all_of(found.shifts, &ToolShift::told)) return;
  fmt::print(
      "what these positions do not tell to the budget is not verified: read inclinations on "
      "either side of 90 deg and there, each at several azimuths and at toolfaces every 90 deg\n");
}

// Those that matter to readings at rest; where there is no default, the user must say.
void AddBenchSigmas(CLI::App& command, ToolFitSetup& bench) {
  for (const BenchSigma& sigma : BenchSigmas()) {
    const std::string_view of_others[] = {"latitude-sigma-deg",
                                          "seat-arcsec",
                                          "rate-scale-ppm",
                                          "drift-deg-per-h",
                                          "sigma-table-deg-per-h",
                                          "second-order-ug-per-g2",
                                          "anisoelastic-deg-per-h-per-g2"};
    if (std::find(std::begin(of_others), std::end(of_others), sigma.name) != std::end(of_others)) {
      continue;
    }
    AddSigma(command, sigma, bench, sigma.name == "wobble-arcsec" ? "none if not given" : "needed");
  }
}

int Verify(VerifyOptions& o) {
  constexpr int kFailed = 4;
  TakeGravity(o.bench);
  o.setup.bench.reference = o.bench.reference;
  const auto data = ReadBenchTable(o.bench.data);
  if (!data) return Unusable(data.fault());
  const auto tool = ReadToolFile(o.bench.tool);
  if (!tool) return Unusable(tool.fault());
  const auto found = VerifyTool(*data, *tool, o.setup);
  if (!found) return Unusable(found.fault());
  TellShifts(*found);
  TellResiduals(*found);
  TellOutcome(*found);
  if (found->outcome == VerifyOutcome::kFail && !o.bench.gravity_stated &&
      tool->accel.n_channels > 0) {
    fmt::print(
        "gravity was taken for {:.6g} m/s2: where the calibration took another, say that one "
        "(--gravity-mps2, or --gravity-g 1 for standard)\n",
        o.bench.reference.gravity_mps2);
  }
  return found->outcome == VerifyOutcome::kPass ? kDone : kFailed;
}

}  // namespace

void AddCalibrateVerify(CLI::App& calibrate, int& exit_code) {
  const auto o = std::make_shared<VerifyOptions>();
  CLI::App* const command = calibrate.add_subcommand(
      "verify", "a tool against its calibration, as found or as left: shifts, pass or fail");
  command->add_option("--data", o->bench.data, "readings at rest (CSV), columns as tool's")
      ->required();
  command->add_option("--tool", o->bench.tool, "tool file (TOML)")->required();
  AddGravity(*command, o->bench);
  AddLatitude(*command, o->bench);
  AddAxes(*command, o->bench);
  AddBenchSigmas(*command, o->setup.bench);
  AddPositive(*command, "--budget-bias-deg-per-h", o->setup.budget_gyro_bias, 1,
              "1 sigma of gyro biases that the tool may have");
  AddPositive(*command, "--budget-force-deg-per-h-per-g", o->setup.budget_gyro_force, 1,
              "of their force terms");
  AddPositive(*command, "--budget-accel-mg", o->setup.budget_accel_bias, 1e-3,
              "of accelerometer biases");
  command->footer(
      "Example:\n  wellgyro calibrate verify --data found.csv --tool tool.toml \\\n"
      "      --latitude-deg 60 --sigma-deg-per-h 0.02 --sigma-accel 2e-5 \\\n"
      "      --budget-bias-deg-per-h 0.05\n"
      "Exit code 4: fail, or not verified: these positions do not tell every shift.");
  OnCall(command, exit_code, [o] { return Verify(*o); });
}

}  // namespace wellgyro::apps
