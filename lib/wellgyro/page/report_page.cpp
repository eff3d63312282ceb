#include "wellgyro/page/report_page.h"

#include <cstdint>
#include <exception>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/io/sha256.h"
#include "wellgyro/page/assets_internal.h"
#include "wellgyro/page/html_internal.h"
#include "wellgyro/page/page_internal.h"

namespace wellgyro {
namespace {

/// Base64 (RFC 4648) of a SHA-256, as policies name what may run.
std::string PolicyHash(std::string_view script) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::string hex = Sha256Hex(script);
  std::string base64 = "'sha256-";
  for (std::size_t i = 0; i < hex.size(); i += 6) {
    const std::string part = hex.substr(i, 6);
    const auto bits = static_cast<std::uint32_t>(
        std::stoul(part + std::string(6 - part.size(), '0'), nullptr, 16));
    const std::size_t digits = part.size() == 6 ? 4 : part.size() / 2 + 1;
    for (std::size_t k = 0; k < 4; ++k) {
      base64 += k < digits ? kDigits[(bits >> (18 - 6 * k)) & 63u] : '=';
    }
  }
  return base64 + "'";
}

/// JSON as it may stand within a script element: no sign in it can end the element.
std::string InScript(const Json& json) {
  std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace), safe;
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string_view PaperName(ReportOptions::Paper paper) {
  return paper == ReportOptions::Paper::kA4 ? "A4" : "letter";
}

void WriteHeadElement(PageText& page, const std::string& style) {
  const std::string policy = fmt::format(
      "default-src 'none'; script-src {} {}; style-src {}; img-src data:; base-uri 'none'; "
      "form-action 'none'",
      PolicyHash(D3Script()), PolicyHash(ReportScript()), PolicyHash(style));
  page.html += fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>{} - gyro survey report</title>\n"
      "<style>{}</style>\n</head>\n<body>\n",
      policy, Escaped(Clipped(TextAt(page.survey, {"run", "well", "name"}), 100)), style);
}

/// Repeated by every print on each of its pages.
void WriteRunningHead(PageText& page) {
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

/// The document and the charts for the script, then D3 with its licence and the script.
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
  page.html +=
      "<details class=\"licence\"><summary>Licence of the charts' library D3, which is part of "
      "this page</summary><pre>";
  for (const char c : D3Licence()) page.html += c == '\n' ? std::string("\n") : Escaped({&c, 1});
  page.html += "</pre></details>\n<script>";
  page.html += D3Script();
  page.html += "</script>\n<script>";
  page.html += ReportScript();
  page.html += "</script>\n</body>\n</html>\n";
}

}  // namespace

Result<std::string> ReportPage(std::string_view survey_json, const ReportOptions& options) {
  Json survey;
  try {
    survey = Json::parse(survey_json);
  } catch (const std::exception& error) {
    return Fault{.code = FaultCode::kSyntax, .text = error.what(), .source = "survey.json"};
  }
  if (TextAt(survey, {"format"}) != "wellgyro.survey/1") {
    return Fault{.code = FaultCode::kForeign,
                 .text = "its format is not wellgyro.survey/1",
                 .source = "survey.json"};
  }
  PageText page{.survey = survey, .units = UnitsOf(options.units), .paper = options.paper};
  const std::string style = std::string(ReportStyle()) +
                            fmt::format("@page{{size:{} portrait}}\n", PaperName(options.paper));
  WriteHeadElement(page, style);
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
  WriteScripts(page);
  return std::move(page.html);
}

}  // namespace wellgyro
