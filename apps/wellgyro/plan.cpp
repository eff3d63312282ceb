#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/result/plan_files.h"
#include "wellgyro/io/toml/tool_file.h"

#include "answer.h"
#include "commands.h"
#include "on_call.h"
#include "place_options.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

constexpr double kRpm = kTwoPi / 60;

struct PlanOptions {
  PlanRequest request;
  std::string practice, date, out;
};

/// "every_m=300,stop_s=180", in any order, both or one of them.
PracticeSpec PracticeOf(const std::string& text) {
  PracticeSpec spec;
  for (const std::string& part : CLI::detail::split(text, ',')) {
    const std::size_t at = part.find('=');
    const std::string key = part.substr(0, at);
    double value = 0;
    if (at == std::string::npos || !CLI::detail::lexical_cast(part.substr(at + 1), value)) {
      throw std::invalid_argument("--practice takes every_m=300,stop_s=180, not " + part);
    }
    if (key == "every_m" && value >= 1 && value <= 1e4) {
      spec.every = value;
    } else if (key == "stop_s" && value >= 1 && value <= 7200) {
      spec.seconds = value;
    } else {
      throw std::invalid_argument(
          "--practice takes every_m of 1 to 10000 and stop_s of 1 to 7200, not " + part);
    }
  }
  return spec;
}

void AddPlanFiles(CLI::App& command, PlanOptions& o) {
  PlanRequest& r = o.request;
  command
      .add_option("--well", r.well,
                  "the well as planned, or as surveyed before: any format of 'convert'")
      ->required()
      ->type_name("FILE");
  command
      .add_option(
          "--tool", r.tool,
          "job (wellgyro.job/1), for the tool's noise and errors and the well's latitude, or "
          "tool file with --noise and --latitude-deg")
      ->required()
      ->type_name("FILE");
  command.add_option("--noise", r.noise, "noise file of the gyros, in place of the job's")
      ->type_name("FILE");
  command.add_option("--out", o.out, "folder for plan.toml, plan.svg, plan.txt and expected.csv")
      ->required();
}

void AddLimits(CLI::App& command, PlanOptions& o) {
  PlanLimits& l = o.request.limits;
  command
      .add_option("--ellipse-m", l.ellipse, "semi-major axis of the end's 95 % ellipse, at most")
      ->required()
      ->check(CLI::Range(1e-3, 1e4));
  command
      .add_option("--hidden-m", l.hidden,
                  "shift of the end by the worst fault that would stay unseen, at most")
      ->check(CLI::Range(1e-3, 1e5));
  command.add_option("--practice", o.practice,
                     "what is done today, for comparison: every_m=300,stop_s=180");
  command.add_option("--least-stop-s", l.least_stop, "shortest stop, default 60")
      ->check(CLI::Range(10.0, 7200.0));
  command.add_option("--longest-stop-s", l.longest_stop, "longest stop, default 900")
      ->check(CLI::Range(10.0, 7200.0));
  command.add_option("--overhead-s", l.overhead, "what a stop costs beside its rest, default 30")
      ->check(CLI::Range(0.0, 7200.0));
  command.add_flag("--toolfaces", l.turns,
                   "the tool can be turned before a stop, and back: toolfaces are chosen too");
}

void AddWay(CLI::App& command, PlanOptions& o) {
  PlanRequest& r = o.request;
  AddNumber(command, "--latitude-deg", r.latitude, units::kDeg, "else the job's")
      ->check(CLI::Range(-89.0, 89.0));
  AddNumber(command, "--convergence-deg", r.convergence, units::kDeg,
            "true less grid azimuth, of a well whose azimuths are grid");
  command.add_option("--begin-md-m", r.begin_md, "where the survey begins, else the well does");
  command.add_option("--end-md-m", r.end_md, "its deepest point, else the well's");
  command.add_option("--speed-mps", r.way.speed_in, "on the way down, default 0.8");
  command.add_option("--speed-out-mps", r.way.speed_out,
                     "on the way up, default 0.8; 0: it is not surveyed");
  AddNumber(command, "--roll-rpm", r.way.roll_rate, kRpm,
            "of the moving tool; 0, the default: it slides and swings a little");
  AddNumber(command, "--sigma-azimuth-deg", r.sigma_start_azimuth, units::kDeg,
            "1 sigma of an azimuth that is told at the begin; else as the job's alignment says")
      ->check(CLI::Range(1e-4, 90.0));
  command.add_flag("--third-axis", r.third_axis, "the tool has a third gyro axis");
  command.add_option("--surface-degc", r.heat.at_surface, "temperature at the surface, default 10");
  AddNumber(command, "--gradient-degc-per-km", r.heat.gradient, 1e-3,
            "of the formation, to be held against the tool's calibration")
      ->check(CLI::Range(0.0, 200.0));
  command.add_option("--date", o.date, "of the run, to be held against the tool's calibration")
      ->type_name("2026-01-31");
}

int RunPlan(PlanOptions& o) {
  if (!o.date.empty()) {
    o.request.date = wellgyro::DateOf(o.date);
    if (!o.request.date) {
      throw std::invalid_argument(fmt::format("--date: \"{}\" is no date, as 2026-01-31", o.date));
    }
  }
  if (!o.practice.empty()) o.request.practice = PracticeOf(o.practice);
  const Result<PlanAnswer> answer = AnswerPlan(o.request);
  if (const auto code = WriteAnswer(answer, o.out)) return *code;
  fmt::print("{}", answer->summary);
  return answer->feasible ? kDone : kUnfit;
}

}  // namespace

void AddPlan(CLI::App& app, int& exit_code) {
  CLI::App* const command = app.add_subcommand(
      "plan", "Finds where a run should stop, how long, and what each stop buys");
  const auto options = std::make_shared<PlanOptions>();
  AddPlanFiles(*command, *options);
  AddLimits(*command, *options);
  AddWay(*command, *options);
  command->footer(
      "Example:\n  wellgyro plan --well survey.csv --tool data/demo/job.toml --ellipse-m 25 \\\n"
      "      --roll-rpm 1 --practice every_m=300,stop_s=180 --out plan\n"
      "Exit code 4 where no plan meets the limits.");
  OnCall(command, exit_code, [options] { return RunPlan(*options); });
}

}  // namespace wellgyro::apps
