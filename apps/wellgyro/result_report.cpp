#include "result_report.h"

#include <algorithm>
#include <array>
#include <memory>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/result/result_folder.h"
#include "wellgyro/io/result/survey_json.h"
#include "wellgyro/io/text_file.h"

#include "choice.h"
#include "chromium.h"
#include "commands.h"
#include "distinct.h"
#include "on_call.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

namespace fs = std::filesystem;

/// Writes one file; false where it cannot be, which has been said.
bool Write(const fs::path& path, std::string bytes, bool say) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const std::vector<OutputFile> files{{path.filename().string(), std::move(bytes)}};
  if (const auto fault = WriteFiles(folder, files)) {
    Complain(*fault);
    return false;
  }
  if (say) fmt::print("wrote {}\n", path.string());
  return true;
}

Result<std::string> DocumentOf(const ResultReport& report) {
  Result<ResultTexts> texts = ReadResultTexts(report.result);
  if (!texts) return texts.fault();
  if (std::optional<Fault> altered = AlteredSince(*texts)) {
    altered->source = (report.result / altered->source).string();
    return *altered;
  }
  if (!report.plan.empty()) {
    Result<std::string> plan = ReadTextFile(report.plan);
    if (!plan) return plan.fault();
    (*texts)[kPlanFile] = *std::move(plan);
  }
  std::vector<OtherWell> others;
  for (const std::string& name : report.others) {
    Result<std::string> text = ReadTextFile(name);
    if (!text) return text.fault();
    others.push_back({fs::path(name).stem().string(), *std::move(text)});
  }
  Result<std::string> json = SurveyJson(*texts, others);
  if (json) return json;
  Fault fault = json.fault();
  if (fault.source == kPlanFile) {
    fault.source = report.plan.string();
  } else if (texts->contains(fault.source)) {
    fault.source = (report.result / fault.source).string();
  }
  return fault;
}

/// Throws std::invalid_argument where a file that is written is another of them, or read.
void RequireOthers(const ResultReport& report) {
  RequireDistinct(std::array{NamedFile{"--out", report.out}, NamedFile{"--pdf", report.pdf},
                             NamedFile{"--json", report.json}});
  std::vector<fs::path> inputs(report.others.begin(), report.others.end());
  inputs.push_back(report.plan);
  for (const char* const name : kResultFiles) inputs.push_back(report.result / name);
  if (!report.json.empty()) RequireUnread(inputs, report.json);
  inputs.push_back(report.result / "survey.json");
  for (const fs::path& target : {report.out, report.pdf}) {
    if (!target.empty()) RequireUnread(inputs, target);
  }
}

}  // namespace

int WriteReport(const ResultReport& report) {
  const Result<std::string> json = DocumentOf(report);
  if (!json) return Unusable(json.fault());
  if (!report.json.empty() && !Write(report.json, *json, report.say)) return kUnusable;
  if (report.out.empty()) return kDone;
  Result<std::string> page = ReportPage(*json, report.options);
  if (!page) return Unusable(page.fault());
  if (!Write(report.out, *std::move(page), report.say)) return kUnusable;
  if (report.pdf.empty()) return kDone;
  if (const auto complaint = PrintByChromium(report.out, report.pdf)) return Unusable(*complaint);
  fmt::print("wrote {}\n", report.pdf.string());
  return kDone;
}

int ReportInto(const fs::path& folder, bool page, std::vector<std::string>& written) {
  ResultReport report{.result = folder, .json = folder / "survey.json", .say = false};
  if (page) report.out = folder / "report.html";
  const int code = WriteReport(report);
  if (code != kDone) return code;
  written.emplace_back("survey.json");
  if (page) written.emplace_back("report.html");
  return kDone;
}

namespace {

struct PageOptions {
  std::string result, out, pdf, json, plan;
  std::vector<std::string> others;
  ReportOptions page;
};

/// Units and paper, which change how the page looks and nothing in it.
void AddLook(CLI::App& command, ReportOptions& page) {
  using Units = ReportOptions::Units;
  TakeOneOf<Units>(command.add_option("--units", page.units, "Units of length"),
                   {{"metric", Units::kMetric}, {"field", Units::kField}});
  using Paper = ReportOptions::Paper;
  TakeOneOf<Paper>(command.add_option("--paper", page.paper, "Paper of the print"),
                   {{"a4", Paper::kA4}, {"letter", Paper::kLetter}});
}

}  // namespace

void AddReport(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<PageOptions>();
  CLI::App* command =
      app.add_subcommand("report", "The report of a survey's result folder, as one page");
  command->add_option("RESULT", options->result, "Folder with run.toml and survey.csv")
      ->required()
      ->type_name("DIR");
  command->add_option("--out", options->out, "The page, whole in one file")
      ->required()
      ->type_name("HTML");
  command->add_option("--pdf", options->pdf, "The page printed too, by a Chromium that is here")
      ->type_name("PDF");
  command->add_option("--json", options->json, "All that the page rests on: survey.json")
      ->type_name("JSON");
  command
      ->add_option("--other", options->others,
                   "A survey of another well, drawn beside; in any format that convert reads")
      ->allow_extra_args(false)
      ->type_name("SURVEY");
  command
      ->add_option("--plan", options->plan, "What 'plan' made for the run, to show what came of it")
      ->type_name("PLAN");
  AddLook(*command, options->page);
  command->footer(
      "Example:\n  wellgyro report result --out report.html --pdf report.pdf --other plan.csv");
  OnCall(command, exit_code, [options] {
    const ResultReport report{.result = options->result,
                              .out = options->out,
                              .pdf = options->pdf,
                              .json = options->json,
                              .others = options->others,
                              .plan = options->plan,
                              .options = options->page};
    RequireOthers(report);
    return WriteReport(report);
  });
}

}  // namespace wellgyro::apps
