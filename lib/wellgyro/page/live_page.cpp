#include "wellgyro/page/live_page.h"

#include <fmt/core.h>

#include "wellgyro/io/plot/chart.h"
#include "wellgyro/io/result/other_well_internal.h"
#include "wellgyro/page/assets_internal.h"
#include "wellgyro/page/html_head_internal.h"
#include "wellgyro/page/html_internal.h"

namespace wellgyro {
namespace {

constexpr std::size_t kShown = 60;  // letters of a name in the running head

std::string IdentityOf(const LivePageHead& head, std::string_view key) {
  for (const auto& [name, value] : head.identity) {
    if (name == key) return Isolated(Clipped(value, kShown));
  }
  return {};
}

std::string RunningHead(const LivePageHead& head) {
  return fmt::format(
      "<header class=\"running\"><span class=\"what\">Gyro survey, live</span>"
      "<span class=\"well\">{}</span><span>{}</span><span>{}</span><span>{}</span>"
      "<span class=\"word\" id=\"verdict\"></span></header>\n",
      Isolated(Clipped(head.well, kShown)), IdentityOf(head, "operator"), IdentityOf(head, "field"),
      IdentityOf(head, "rig"));
}

/// A figure that changes: its name, the id of the large text, and that of a line below.
std::string Tile(std::string_view name, std::string_view id, std::string_view below,
                 std::string_view kind = "big") {
  std::string tile = fmt::format("<div><dt>{}</dt><dd class=\"{}\" id=\"now-{}\">\u2013</dd>",
                                 Escaped(name), kind, id);
  if (!below.empty()) tile += fmt::format("<dd class=\"small\" id=\"now-{}\"></dd>", below);
  return tile + "</div>\n";
}

std::string Now() {
  return "<section><h2>Now</h2>\n<dl class=\"tiles\">\n" +
         Tile("Depth of the reference, MD [m]", "md", "time") +
         Tile("Speed, down-hole positive [m/s]", "speed", "") +
         Tile("Inclination, last station [\u00b0]", "inc", "") +
         Tile("Azimuth true, last station [\u00b0]", "azi", "sigma") +
         Tile("At rest", "rest", "more") + Tile("Stations", "stations", "stop") +
         Tile("Samples lost", "lost", "") + Tile("Checks", "checks", "turned", "big words") +
         "<div id=\"advice\" hidden><dt>Advice, for the plan's limits</dt>"
         "<dd class=\"big words\" id=\"now-advice\"></dd>"
         "<dd class=\"small\" id=\"now-advised\"></dd></div>\n"
         "</dl>\n<p id=\"causes\"></p></section>\n";
}

std::string Figure(std::string_view id, std::string_view until) {
  return fmt::format(
      "<figure class=\"chart\" id=\"{}\" tabindex=\"0\"><p class=\"absent\">{}</p></figure>\n", id,
      Escaped(until));
}

std::string Charts() {
  constexpr std::string_view kNoStation = "No stations yet.", kNoPair = "No second pass yet.";
  std::string html = "<section><h2>Path</h2><div class=\"pair\">\n";
  html += Figure("plan", kNoStation) + Figure("section", kNoStation);
  html += "</div></section>\n<section><h2>In-run and out-run</h2><div class=\"pair\">\n";
  html += Figure("inclination", kNoStation) + Figure("azimuth", kNoStation);
  html += Figure("d-inclination", kNoPair) + Figure("d-azimuth", kNoPair);
  return html + "</div></section>\n";
}

/// A table whose rows the script writes.
std::string Table(std::string_view id, std::string_view kind,
                  std::initializer_list<std::string_view> heads) {
  std::string html;
  { const HtmlTable table(html, kind, "", heads); }
  const std::string_view body = "<tbody>";
  html.replace(html.find(body), body.size(), fmt::format("<tbody id=\"{}\">", id));
  return html;
}

std::string OrderForm() {
  return "<form id=\"order\"><label>Order<select name=\"what\"><option>remark</option>"
         "<option>adjust</option><option>accept</option><option>reject</option></select></label>"
         "<label>Your name<input name=\"who\" maxlength=\"100\" required></label>"
         "<label>Text<input name=\"text\" maxlength=\"500\" size=\"40\"></label>"
         "<label>MD [m], of one depth<input name=\"md_m\" type=\"number\" step=\"any\"></label>"
         "<label>Run<input name=\"run\" type=\"number\" min=\"1\" step=\"1\"></label>"
         "<button id=\"send\">Sign and send</button>"
         "<p id=\"answer\" role=\"status\"></p></form>\n";
}

std::string Tables(bool orders) {
  std::string html = "<section><h2>Operations</h2>\n";
  if (orders) html += OrderForm();
  html += Table("operations", "", {"Time", "Kind", "Key", "Who", "", "Effect"});
  html += "<h3>What the survey says</h3><ol id=\"notices\"></ol></section>\n";
  html +=
      "<section><h2>Checks</h2>\n" +
      Table("checks", "checks",
            {"Verdict", "Check", "Run", "Pass", ">MD [m]", ">Value", ">Sigma", ">Limit", "Unit",
             "Limit from"}) +
      "<details><summary id=\"undone-count\">Checks not done</summary>\n" +
      Table("undone", "checks",
            {"Verdict", "Check", "Run", "Pass", ">MD [m]", ">Value", ">Sigma", ">Limit", "Unit",
             "Why not done"}) +
      "</details></section>\n<section><h2>Stations, the newest first</h2><div class=\"tall\">\n";
  html += Table("stations", "listing",
                {">MD [m]", ">Inc [\u00b0]", ">Azi true [\u00b0]", ">\u03c3 inc [\u00b0]",
                 ">\u03c3 azi [\u00b0]", ">TVD [m]", ">N [m]", ">E [m]", ">Run", "Pass", "Kind",
                 "Status", ">Revision", "Quality"});
  return html + "</div></section>\n";
}

}  // namespace

Result<std::string> LivePage(const LivePageHead& head) {
  Json shown{{"plan", nullptr}, {"help", ChartColour(kHelpColour)}, {"colours", Json::array()}};
  for (int i = 0; i < kHelpColour; ++i) shown["colours"].push_back(ChartColour(i));
  if (head.plan) {
    Result<Json> plan = WellJson(*head.plan);
    if (!plan) return plan.fault();
    shown["plan"] = std::move(*plan);
  }
  const std::string style = std::string(ReportStyle()) + std::string(LiveStyle());
  const std::vector<std::string_view> scripts{D3Script(), ChartsScript(), LiveScript()};
  std::string page =
      HeadElement(Clipped(head.well, kShown) + " - gyro survey, live", style, scripts, "'self'");
  page += RunningHead(head);
  page +=
      "<div id=\"link\" class=\"verdict warn\" role=\"alert\">Connecting to the survey.</div>\n";
  page +=
      "<noscript><p>This page needs JavaScript; the report of the survey does "
      "not.</p></noscript>\n";
  page += "<main>\n" + Now() + Charts() + Tables(head.orders) + "</main>\n";
  page += "<div id=\"readout\" role=\"status\" hidden></div>\n";
  page += "<script type=\"application/json\" id=\"head\">" + InScript(shown) + "</script>\n";
  page += TailElements(scripts);
  return page;
}

}  // namespace wellgyro
