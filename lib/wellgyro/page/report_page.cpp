#include "wellgyro/page/report_page.h"

#include <exception>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/io/formats.h"
#include "wellgyro/page/assets_internal.h"
#include "wellgyro/page/html_head_internal.h"
#include "wellgyro/page/html_internal.h"
#include "wellgyro/page/page_internal.h"

namespace wellgyro {
namespace {

std::vector<std::string_view> Scripts() { return {D3Script(), ChartsScript(), ReportScript()}; }

std::string_view PaperName(ReportOptions::Paper paper) {
  return paper == ReportOptions::Paper::kA4 ? "A4" : "letter";
}

/// Repeated by every print on each of its pages.
void WriteRunningHead(PageText& page) {
  // Letters of each of three names, so that the head stays a line or two of a printed page.
  constexpr std::size_t kMost = 48;
  const Json& run = At(page.survey, {"run"});
  const auto clipped = [&](std::string_view group, std::string_view key) {
    return Isolated(Clipped(TextAt(run, {group, key}), kMost));
  };
  page.html += fmt::format(
      "<table class=\"sheet\" role=\"presentation\"><thead><tr><td><div class=\"running\">"
      "<span class=\"what\">Gyro survey</span><span "
      "class=\"well\">{}</span><span>{}</span><span>{}</span>"
      "<span class=\"word {}\">verdict {}</span></div></td></tr></thead>\n<tbody><tr><td><main>\n",
      clipped("well", "name"), clipped("identity", "operator"), clipped("identity", "field"),
      Escaped(Clipped(TextAt(run, {"verdict", "verdict"}), 10)), clipped("verdict", "verdict"));
}

/// The document and the charts for the script, then the scripts.
void WriteScripts(PageText& page) {
  page.html +=
      "</main></td></tr></tbody></table>\n<div id=\"readout\" role=\"status\" hidden></div>\n";
  page.html +=
      "<script type=\"application/json\" id=\"survey\">" + InScript(page.survey) + "</script>\n";
  page.html += "<script type=\"application/json\" id=\"charts\">" +
               InScript({{"length", page.units.length},
                         {"unit", page.units.length_name},
                         {"charts", page.charts}}) +
               "</script>\n";
  page.html += TailElements(Scripts());
}

}  // namespace

Result<std::string> ReportPage(std::string_view survey_json, const ReportOptions& options) {
  Json survey;
  try {
    survey = Json::parse(survey_json);
  } catch (const std::exception& error) {
    return Fault{.code = FaultCode::kSyntax, .text = error.what(), .source = "survey.json"};
  }
  if (TextAt(survey, {"format"}) != formats::kSurvey) {
    return Fault{.code = FaultCode::kForeign,
                 .text = "its format is not wellgyro.survey/1",
                 .source = "survey.json"};
  }
  PageText page{.survey = survey, .units = UnitsOf(options.units), .paper = options.paper};
  const std::string style = std::string(ReportStyle()) +
                            fmt::format("@page{{size:{} portrait}}\n", PaperName(options.paper));
  page.html +=
      HeadElement(Clipped(TextAt(survey, {"run", "well", "name"}), 100) + " - gyro survey report",
                  style, Scripts(), "'none'");
  WriteRunningHead(page);
  WriteVerdict(page);
  WriteHead(page);
  WriteMaps(page);
  WriteStops(page);
  WritePasses(page);
  WriteFits(page);
  WriteChecks(page);
  WriteDiagnosis(page);
  WriteListing(page);
  WriteSources(page);
  WritePlan(page);
  WriteScripts(page);
  return std::move(page.html);
}

}  // namespace wellgyro
