#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/result/compare_files.h"
#include "wellgyro/io/words.h"

#include "answer.h"
#include "commands.h"
#include "on_call.h"
#include "place_options.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct CompareOptions {
  CompareRequest request;
  std::string first, second, out;
};

int RunCompare(CompareOptions& o) {
  o.request.first = o.first;
  o.request.second = o.second;
  const Result<CompareAnswer> answer = AnswerCompare(o.request);
  if (!answer) return Unusable(answer.fault());
  if (o.out.empty()) {
    for (const std::string& note : answer->notes) fmt::print(stderr, "note: {}\n", note);
  } else if (const auto code = WriteAnswer(answer, o.out)) {
    return *code;
  }
  const RunVerdict& verdict = answer->comparison.verdict;
  fmt::print("{}\n", answer->summary);
  for (const std::string& cause : verdict.causes) fmt::print("{}\n", cause);
  fmt::print("verdict: {}\n", WordOf(verdict.verdict));
  for (const std::string& why : answer->refusals) Complain("the comparison ends before " + why);
  if (verdict.verdict == Verdict::kFail) return kUnfit;
  return answer->refusals.empty() ? kDone : kDoneWithLosses;
}

}  // namespace

void AddCompare(CLI::App& app, int& exit_code) {
  CLI::App* const command = app.add_subcommand(
      "compare", "Holds two surveys of one hole against each other, each difference in its sigmas");
  const auto options = std::make_shared<CompareOptions>();
  CompareRequest& r = options->request;
  command->add_option("A", options->first, "survey file, or program of legs (.toml)")->required();
  command->add_option("B", options->second, "the same of the other")->required();
  command->add_option("--model-a", r.first_model,
                      "error model of A: a name of 'wellgyro models' or a file (default: the "
                      "covariances and sigmas in A)");
  command->add_option("--model-b", r.second_model, "error model of B");
  command->add_flag("--same-run", r.options.same_run,
                    "both are passes of one tool in one run: systematic errors are common");
  command->add_option("--at", r.options.at, "measured depths [m] to compare at, with commas")
      ->delimiter(',');
  command->add_option("--every", r.options.every, "compare at whole multiples of this depth [m]")
      ->check(CLI::Range(1e-3, 1e6));
  AddNumber(*command, "--local-sigma-deg", r.options.local_sigma, units::kDeg,
            "1 sigma of each direction difference that no model speaks of, default 0.05")
      ->check(CLI::Range(1e-6, 50.0));
  AddPlace(*command, r.surroundings, r.convergence);
  command->add_option("--out", options->out, "folder for compare.csv, checks.csv, compare.toml");
  command->footer(
      "Differences are B less A at the same measured depth. Example:\n"
      "  wellgyro compare mwd.csv gyro.csv --model-a 'ISCWSA MWD Rev 4' \\\n"
      "      --model-b GYRO-NS-CT --latitude-deg 60 --field-nt 50000 --dip-deg 70 \\\n"
      "      --declination-deg 0 --out compared\n"
      "Exit code 4 where the surveys differ by more than their errors allow.");
  OnCall(command, exit_code, [options] { return RunCompare(*options); });
}

}  // namespace wellgyro::apps
