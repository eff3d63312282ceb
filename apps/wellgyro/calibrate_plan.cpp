#include <array>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/fit/bench_plan.h"
#include "wellgyro/io/exchange/well_stations.h"
#include "wellgyro/io/text_file.h"

#include "bench_options.h"
#include "calibrate_tool.h"
#include "commands.h"
#include "distinct.h"
#include "on_call.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

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
  RequireDistinct(std::array{NamedFile{"--well", o.well}, NamedFile{"--out", o.out}});
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
    // Clockwise: 350 to 10 goes through north.
    const double turn = o.azimuth_deg[1] < o.azimuth_deg[0] ? 360 : 0;
    o.setup.azimuth_to = FromDegrees(o.azimuth_deg[1] + turn);
  }
  const BenchPlan plan = PlanBench(o.setup);
  TellPlan(o.setup, plan);
  if (!plan.reached) {
    Complain(
        fmt::format("{} settings do not reach {:.4g} deg; read longer in each (--sigma-deg-per-h)",
                    plan.settings.size(), ToDegrees(plan.wanted)));
  }
  if (const auto fault = WriteAndName(o.out, PlanText(plan))) return Unusable(*fault);
  return plan.reached ? kDone : kUnfit;
}

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
      "      --well planned.csv --out settings.csv\n"
      "Exit code 4: the sigma wanted is not reached.");
  OnCall(command, exit_code, [o] { return Plan(*o); });
}

}  // namespace wellgyro::apps
