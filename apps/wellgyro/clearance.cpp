#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "wellgyro/io/result/clearance_files.h"

#include "answer.h"
#include "choice.h"
#include "commands.h"
#include "on_call.h"
#include "place_options.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct ClearanceOptions {
  ClearanceRequest request;
  std::vector<std::string> offsets;
  std::string out;
};

int RunClearance(ClearanceOptions& o) {
  o.request.offsets.assign(o.offsets.begin(), o.offsets.end());
  Progress progress("offset wells");
  o.request.progress = [&](std::size_t done, std::size_t all) {
    progress.Show(static_cast<std::int64_t>(done), static_cast<std::int64_t>(all));
  };
  const Result<ClearanceAnswer> answer = AnswerClearance(o.request);
  if (const auto code = WriteAnswer(answer, o.out)) return *code;
  constexpr const char* kWords[] = {"pass", "warn", "fail"};
  fmt::print("{}\nverdict: {}\n", answer->summary, kWords[static_cast<int>(answer->verdict)]);
  for (const std::string& why : answer->refusals)
    Complain("not judged, as a model ends before " + why);
  if (answer->verdict == ClearanceVerdict::kFail) return kUnfit;
  return answer->refusals.empty() ? kDone : kDoneWithLosses;
}

}  // namespace

void AddClearance(CLI::App& app, int& exit_code) {
  CLI::App* const command =
      app.add_subcommand("clearance", "Holds a well against others by the ISCWSA separation rule");
  const auto options = std::make_shared<ClearanceOptions>();
  ClearanceRequest& r = options->request;
  command->add_option("--policy", r.policy,
                      "clearance policy (TOML): rule, limits, radii of holes, wells");
  command->add_option("--reference", r.reference, "survey, or program (.toml), of the well");
  command->add_option("--offset", options->offsets, "the same of other wells; any number");
  command->add_option(
      "--model", r.model,
      "error model of surveys that name none: a name of 'wellgyro models' or a file");
  CLI::Option* const option =
      command->add_option("--correlation", r.correlation,
                          "errors that two wells share and so drop out; wins over the policy's");
  TakeOneOf<Correlation>(option, {{"none", Correlation::kNone},
                                  {"global", Correlation::kGlobal},
                                  {"full", Correlation::kFull}});
  AddPlace(*command, r.surroundings, r.convergence);
  command->add_option("--out", options->out, "folder for the results")->required();
  command->footer(
      "Example:\n  wellgyro clearance --reference plan.csv --offset a.csv --offset b.csv \\\n"
      "      --model 'ISCWSA MWD Rev 4' --latitude-deg 60 --field-nt 50000 \\\n"
      "      --dip-deg 70 --declination-deg 0 --policy policy.toml --out clear\n"
      "Exit code 4 where a separation factor is below the policy's stop; 3, and no better than\n"
      "warn, where a model ends before its survey does.");
  OnCall(command, exit_code, [options] { return RunClearance(*options); });
}

}  // namespace wellgyro::apps
