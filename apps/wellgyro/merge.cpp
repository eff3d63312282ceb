#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/result/merge_files.h"
#include "wellgyro/io/words.h"

#include "answer.h"
#include "choice.h"
#include "commands.h"
#include "on_call.h"
#include "place_options.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct MergeOptions {
  MergeRequest request;
  std::string plan, out;
  std::vector<std::string> formats;
};

constexpr const char* kHelp =
    "Example:\n  wellgyro merge plan.toml --latitude-deg 60 --out merged\n"
    "where plan.toml holds\n"
    "  format = \"wellgyro.merge/1\"\n"
    "  [policy]\n"
    "  choose = \"smallest\"            # or \"order\": of the legs as listed\n"
    "  measure = \"horizontal\"         # or vertical, volume: at the end, or at_md_m\n"
    "  min_gain = 0.05                # a change of leg must gain this share\n"
    "  max_gap_m = 60\n"
    "  on_disagreement = \"fail\"       # or \"note\": of legs that overlap\n"
    "  [parent]                       # of a side-track\n"
    "  program = \"parent/program.toml\"\n"
    "  kick_off_md_m = 900\n"
    "  [[leg]]\n"
    "  survey = \"gyro.csv\"\n"
    "  model = \"GYRO-NS-CT\"\n"
    "  run = 1                        # legs of one run share systematic errors\n"
    "  from_md_m = 0\n"
    "  to_md_m = 1200\n"
    "  left_out = \"a reason\"          # to rule it out\n"
    "Exit code 4 where legs that overlap differ by more than their errors allow.";

int RunMerge(MergeOptions& o) {
  o.request.plan = o.plan;
  o.request.formats.clear();
  for (const std::string& word : o.formats) {
    o.request.formats.push_back(*SurveyFormatOf(word));
  }
  const Result<MergeAnswer> answer = AnswerMerge(o.request);
  if (const auto code = WriteAnswer(answer, o.out)) return *code;
  fmt::print("{}\n", answer->summary);
  for (const std::string& cause : answer->verdict.causes) fmt::print("{}\n", cause);
  fmt::print("verdict: {}\n", WordOf(answer->verdict.verdict));
  return answer->verdict.verdict == Verdict::kFail ? kUnfit : kDone;
}

}  // namespace

void AddMerge(CLI::App& app, int& exit_code) {
  CLI::App* const command = app.add_subcommand(
      "merge", "Makes one definitive survey of legs of several tools, with every choice's reason");
  const auto options = std::make_shared<MergeOptions>();
  MergeRequest& r = options->request;
  command->add_option("PLAN", options->plan, "legs and policy (TOML)")->required();
  AddPlace(*command, r.surroundings, r.convergence);
  command->add_option("--at", r.at, "measured depths [m] for resampled.csv, with commas")
      ->delimiter(',');
  command->add_option("--every", r.every, "the same at whole multiples of this depth [m]")
      ->check(CLI::Range(1e-3, 1e6));
  CLI::Option* const formats =
      command
          ->add_option("--to", options->formats,
                       "formats of the definitive survey besides CSV, as of 'convert', with commas")
          ->delimiter(',');
  TakeWord(formats, WrittenFormats())->type_name("LIST");
  command->add_option("--out", options->out, "folder for the results")->required();
  command->footer(kHelp);
  OnCall(command, exit_code, [options] { return RunMerge(*options); });
}

}  // namespace wellgyro::apps
