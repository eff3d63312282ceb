#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/calibration/history.h"
#include "wellgyro/fit/bench_plan.h"
#include "wellgyro/fit/tool_verify.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/exchange/well_stations.h"
#include "wellgyro/io/sensor/bench_data.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/io/toml/tool_file.h"
#include "wellgyro/io/words.h"

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

void TellShifts(const Verification& found) {
  for (const ToolShift& shift : found.shifts) {
    const std::string limit =
        shift.limit > 0 ? fmt::format(", limit {:.4g}", shift.limit) : std::string();
    fmt::print("{:<12} {:+.4g} +- {:.2g} {}{}{}{}\n", shift.name, shift.value, shift.sigma,
               shift.unit, limit, shift.shifted ? "  shifted" : "",
               shift.within ? "" : "  out of budget");
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

int Verify(VerifyOptions& o) {
  constexpr int kFailed = 4;
  o.setup.bench.reference = o.bench.reference;
  const auto data = ReadBenchTable(o.bench.data);
  if (!data) return Unusable(data.fault());
  const auto tool = ReadToolFile(o.bench.tool);
  if (!tool) return Unusable(tool.fault());
  const auto found = VerifyTool(*data, *tool, o.setup);
  if (!found) return Unusable(found.fault());
  TellShifts(*found);
  TellResiduals(*found);
  fmt::print("{}: chance reaches {:.2f} sigmas\n", found->pass ? "pass" : "fail", found->reach);
  return found->pass ? kDone : kFailed;
}

struct BenchPlanOptions {
  BenchPlanSetup setup;
  std::string out, well;
  double bench_latitude_deg = 0, well_latitude_deg = 0, sigma_azimuth_deg = 0;
  std::optional<double> convergence_deg;
  std::vector<double> inclination_deg, azimuth_deg;
};

std::string PlanText(const BenchPlan& plan) {
  std::string text = "inc,az,tf,tau\n";
  for (const BenchSetting& at : plan.settings) {
    text += fmt::format("{:.6g},{:.6g},{:.6g},{:.6g}\n", ToDegrees(at.inclination),
                        ToDegrees(at.azimuth), ToDegrees(at.toolface), at.tau);
  }
  return text;
}

// The directions of the well's stations.
std::optional<Fault> TakeWell(const BenchPlanOptions& o, BenchPlanSetup& setup) {
  const Result<std::string> text = ReadTextFile(o.well);
  if (!text) return text.fault();
  const auto well = ParseWellStations(*text, o.well);
  if (!well) return well.fault();
  if (well->north == North::kGrid && !o.convergence_deg) {
    throw std::invalid_argument("the well's azimuths are grid: --convergence-deg is needed");
  }
  const double turn = well->north == North::kTrue ? 0 : FromDegrees(o.convergence_deg.value_or(0));
  for (const SurveyPoint& at : well->stations) {
    setup.hole.push_back({at.inclination, at.azimuth + turn});
  }
  return std::nullopt;
}

void TellPlan(const BenchPlanSetup& setup, const BenchPlan& plan) {
  const auto plain = PlainSettings(setup.temperatures);
  const char* const of =
      setup.criterion == BenchPlanSetup::Criterion::kMean ? "root mean square" : "at most";
  fmt::print("{} settings: azimuth sigma {} {:.4g} deg in this hole\n", plan.settings.size(), of,
             ToDegrees(plan.sigma_azimuth));
  fmt::print("plain bench, {} settings: {} {:.4g} deg\n", plain.size(), of,
             ToDegrees(AzimuthSigmaOf(plain, setup)));
  fmt::print(
      "no choice of settings, nor of the time in each, reaches {:.4g} deg in less than {:.1f} "
      "settings' time\n",
      ToDegrees(plan.wanted), plan.fewest);
}

int Plan(BenchPlanOptions& o) {
  if (!o.well.empty()) {
    if (const auto fault = TakeWell(o, o.setup)) return Unusable(*fault);
  }
  o.setup.bench_latitude = FromDegrees(o.bench_latitude_deg);
  o.setup.well_latitude = FromDegrees(o.well_latitude_deg);
  o.setup.sigma_azimuth = FromDegrees(o.sigma_azimuth_deg);
  if (!o.inclination_deg.empty()) {
    o.setup.inclination_from = FromDegrees(o.inclination_deg[0]);
    o.setup.inclination_to = FromDegrees(o.inclination_deg[1]);
  }
  if (!o.azimuth_deg.empty()) {
    o.setup.azimuth_from = FromDegrees(o.azimuth_deg[0]);
    o.setup.azimuth_to = FromDegrees(o.azimuth_deg[1]);
  }
  const BenchPlan plan = PlanBench(o.setup);
  TellPlan(o.setup, plan);
  if (!plan.reached) {
    Complain(
        fmt::format("{} settings do not reach {:.4g} deg; read longer in each (--sigma-deg-per-h)",
                    plan.settings.size(), ToDegrees(plan.wanted)));
  }
  if (const auto fault = WriteAndName(o.out, PlanText(plan))) return Unusable(*fault);
  return plan.reached ? kDone : kUnusable;
}

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
  AddPositive(*command, "--sigma-accel", o->setup.bench.sigma_accel, 1, "of a reading, its unit");
  AddPositive(*command, "--sigma-deg-per-h", o->setup.bench.sigma_gyro, 1, "of a gyro's reading");
  AddPositive(*command, "--wobble-arcsec", o->setup.bench.sigma_wobble, units::kArcsec,
              "1 sigma of each reading's attitude");
  AddPositive(*command, "--level-deg", o->setup.bench.sigma_level, units::kDeg,
              "1 sigma of the bench's tilt, default 0.5");
  AddPositive(*command, "--north-sigma-deg", o->setup.bench.sigma_north, units::kDeg,
              "1 sigma of its north, default 1");
  AddPositive(*command, "--budget-bias-deg-per-h", o->setup.budget_gyro_bias, 1,
              "1 sigma of gyro biases that the tool may have");
  AddPositive(*command, "--budget-force-deg-per-h-per-g", o->setup.budget_gyro_force, 1,
              "of their force terms");
  AddPositive(*command, "--budget-accel-mg", o->setup.budget_accel_bias, 1e-3,
              "of accelerometer biases");
  command->footer(
      "Example:\n  wellgyro calibrate verify --data found.csv --tool tool.toml --latitude-deg 60 "
      "\\\n"
      "      --sigma-deg-per-h 0.02 --sigma-accel 2e-5 --budget-bias-deg-per-h 0.05\n"
      "Exit code 4: fail.");
  OnCall(command, exit_code, [o] { return Verify(*o); });
}

namespace {

// What it is for: a well, or all directions in ranges.
void AddHole(CLI::App& command, BenchPlanOptions& o) {
  CLI::Option* const well =
      command
          .add_option("--well", o.well, "the job's, planned or surveyed: any format of 'convert'")
          ->type_name("FILE");
  command
      .add_option("--convergence-deg", o.convergence_deg,
                  "true less grid azimuth, of a well whose azimuths are grid")
      ->check(Within(-180, 180))
      ->needs(well);
  command.add_option("--inclination-deg", o.inclination_deg, "of the hole: from, to")
      ->expected(2)
      ->check(Within(0, 180))
      ->excludes(well);
  command.add_option("--azimuth-deg", o.azimuth_deg, "of the hole: from, to (clockwise)")
      ->expected(2)
      ->check(Within(-360, 360))
      ->excludes(well);
  AddPositive(command, "--rate-table-arcsec", o.setup.sigma_sensitivity, units::kArcsec,
              "a rate table is read too: 1 sigma of the tool's seat on it");
}

}  // namespace

void AddCalibratePlan(CLI::App& calibrate, int& exit_code) {
  const auto o = std::make_shared<BenchPlanOptions>();
  CLI::App* const command = calibrate.add_subcommand(
      "plan", "the fewest gyro positions that reach an azimuth sigma at the job's latitude");
  command->add_option("--bench-latitude-deg", o->bench_latitude_deg, "of the bench")
      ->required()
      ->check(Within(-85, 85));
  command->add_option("--latitude-deg", o->well_latitude_deg, "of the job")
      ->required()
      ->check(Within(-85, 85));
  command
      ->add_option("--azimuth-sigma-deg", o->sigma_azimuth_deg,
                   "wanted, default that of the plain bench")
      ->check(Within(1e-6, 90));
  AddHole(*command, *o);
  AddPositive(*command, "--sigma-deg-per-h", o->setup.sigma_gyro, 1, "of a reading, default 0.02");
  command->add_option("--temperatures", o->setup.temperatures, "stops of the chamber, 1 to 5")
      ->check(CLI::Range(1, 5));
  command->add_flag_callback(
      "--mean", [o] { o->setup.criterion = BenchPlanSetup::Criterion::kMean; },
      "the azimuth's root mean square over the hole, in place of its largest sigma");
  command->add_flag_callback(
      "--d-optimal", [o] { o->setup.criterion = BenchPlanSetup::Criterion::kDeterminant; },
      "all parameters alike, in place of the azimuth");
  command->add_option("--out", o->out, "settings (CSV); tau is -1 coldest to 1 hottest")
      ->required();
  command->footer(
      "Example:\n  wellgyro calibrate plan --bench-latitude-deg 52 --latitude-deg 60 \\\n"
      "      --well planned.csv --out settings.csv");
  OnCall(command, exit_code, [o] { return Plan(*o); });
}

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
