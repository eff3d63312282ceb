#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/result/uncertainty_files.h"

#include "answer.h"
#include "choice.h"
#include "commands.h"
#include "on_call.h"
#include "place_options.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct UncertaintyOptions {
  UncertaintyRequest request;
  std::string allan;
  std::string out;
  bool same_hole = false;
};

void AddSurveyFiles(CLI::App& command, UncertaintyOptions& o) {
  UncertaintySources& s = o.request.sources;
  command.add_option("--survey", s.survey,
                     "survey CSV: MD, INC, AZI; metres or feet by its header");
  command.add_option("--model", s.model,
                     "error model: a name of 'wellgyro models', as GYRO-NS-CT, or a file");
  command.add_option("--noise", s.noise, "noise file of a gyro, from 'wellgyro allan'");
  command.add_option("--program", s.program, "survey program (TOML): legs of survey, model, run");
  command.add_option("--other", o.request.other, "another survey: write the separation from it");
  command.add_option("--other-model", o.request.other_model, "its error model, if not the same");
  command.add_flag("--same-hole", o.same_hole,
                   "the other survey is of the same hole: compare at equal MD");
  CLI::Option* const option =
      command.add_option("--correlation", o.request.correlation,
                         "errors that both surveys share and so drop out; default global");
  TakeOneOf<Correlation>(option, {{"none", Correlation::kNone},
                                  {"global", Correlation::kGlobal},
                                  {"full", Correlation::kFull}});
  command.add_option("--out", o.out, "folder for the results")->required();
}

void AddNumbers(CLI::App& command, UncertaintyOptions& o) {
  UncertaintyRequest& r = o.request;
  AddPlace(command, r.surroundings, r.convergence);
  AddNumber(command, "--speed-mps", r.speed, 1, "of the tool along hole, with --noise");
  AddNumber(command, "--initialise-deg", r.initialise, units::kDeg,
            "inclination where the continuous survey starts; below 0: at the first station "
            "(default: the model's, else 15)");
  AddNumber(command, "--sigma-azimuth-deg", r.sigma_azimuth, units::kDeg,
            "1 sigma of the fix that starts it, with --noise alone");
  command
      .add_option_function<std::vector<double>>(
          "--tie-in-sigma-m",
          [&r](const std::vector<double>& v) {
            r.sigma_tie_in = {v[0], v[1], v[2]};
          },
          "1 sigma of the first station's place: north, east, down")
      ->expected(3)
      ->check(CLI::Range(0.0, 1e5));
  command.add_option("--confidence", r.confidence, "of the ellipses, default 0.95")
      ->check(CLI::Range(1e-6, 1 - 1e-9));
}

int RunUncertainty(UncertaintyOptions& o) {
  o.request.form = o.allan == "printed" ? AllanForm::kPrinted : AllanForm::kExact;
  o.request.pairing = o.same_hole ? Pairing::kSameHole : Pairing::kTwoWells;
  const Result<UncertaintyAnswer> answer = AnswerUncertainty(o.request);
  if (const auto code = WriteAnswer(answer, o.out)) return *code;
  fmt::print("{}\n", answer->summary);
  for (const std::string& why : answer->refusals) Complain("the result ends before " + why);
  return answer->refusals.empty() ? kDone : kDoneWithLosses;
}

void RequireNoiseWithAllan(const UncertaintyOptions& o) {
  if (o.request.sources.noise && o.allan.empty()) {
    throw CLI::RequiredError("--allan exact or --allan printed beside --noise");
  }
  if (!o.request.sources.noise && !o.allan.empty()) {
    throw CLI::RequiredError("--noise beside --allan");
  }
}

}  // namespace

void AddUncertainty(CLI::App& app, int& exit_code) {
  CLI::App* const command = app.add_subcommand(
      "uncertainty", "Finds position covariances and ellipses of a survey by an error model");
  const auto options = std::make_shared<UncertaintyOptions>();
  AddSurveyFiles(*command, *options);
  AddNumbers(*command, *options);
  TakeWord(command->add_option(
               "--allan", options->allan,
               "how the noise file enters: the exact covariance, or the printed recursion"),
           {"exact", "printed"});
  command->add_flag("--terms", options->request.terms, "write every term's part, terms.csv");
  command->add_flag("--plot", options->request.plot, "plan and vertical section, uncertainty.svg");
  command->footer(
      "Example:\n  wellgyro uncertainty --survey survey.csv --model GYRO-NS-CT "
      "\\\n"
      "      --latitude-deg 60 --terms --plot --out results\n"
      "Noise: --noise N.toml --allan exact --speed-mps 0.75, alone or beside --model, where it\n"
      "takes the place of the model's drift and random walk.");
  OnCall(command, exit_code, [options] {
    RequireNoiseWithAllan(*options);
    return RunUncertainty(*options);
  });
}

}  // namespace wellgyro::apps
