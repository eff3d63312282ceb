// Blocks 6 and 7: every check, what explains the run, and what could hide in it.
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/page/html_internal.h"
#include "wellgyro/page/page_internal.h"

namespace wellgyro {
namespace {

void WriteCheck(const PageText& page, HtmlTable& table, const Columns& checks, std::size_t i) {
  const std::string verdict = checks.Text(i, "VERDICT");
  const auto run = checks.Number(i, "RUN");
  table.Row(verdict)
      .Text(verdict == "not_done" ? "not done" : verdict)
      .Text(checks.Text(i, "CODE"))
      .Text(run && *run > 0 ? NumberText(run, 0) : "")
      .Text(checks.Text(i, "PASS"))
      .Number(page.Length(checks.Number(i, "MD[m]")), 2)
      .Short(checks.Number(i, "VALUE"))
      .Short(checks.Number(i, "SIGMA"))
      .Short(checks.Number(i, "LIMIT"))
      .Text(checks.Text(i, "UNIT"))
      .Text(checks.Text(i, "LIMIT_SOURCE"));
}

/// A table of the document as it is.
void WriteTable(PageText& page, const Json& table, std::string_view caption) {
  const Json& columns = At(table, {"columns"});
  page.html += "<div class=\"wide\"><table class=\"data\"><caption>" + Escaped(caption) +
               "</caption><thead><tr>";
  for (const Json& column : columns) {
    page.html += "<th scope=\"col\">" +
                 Escaped(column.is_string() ? column.get<std::string>() : "") + "</th>";
  }
  page.html += "</tr></thead><tbody>\n";
  for (const Json& row : At(table, {"rows"})) {
    page.html += "<tr>";
    for (const Json& cell : row) {
      page.html += cell.is_number()   ? "<td class=\"n\">" + ShortText(cell.get<double>()) + "</td>"
                   : cell.is_string() ? "<td>" + Isolated(cell.get<std::string>()) + "</td>"
                                      : std::string("<td>\u2013</td>");
    }
    page.html += "</tr>\n";
  }
  page.html += "</tbody></table></div>\n";
}

void WriteAllChecks(PageText& page, const Columns& checks) {
  const auto rate = NumberAt(page.survey, {"run", "verdict", "false_alarm_rate"});
  if (rate) {
    page.html += fmt::format(
        "<p>Chance alone fails some check of a run without fault in {:g} % of runs. What failed or "
        "warned stands first, what could not be checked last, with the reason.</p>\n",
        100 * *rate);
  }
  HtmlTable table(page.html, "checks", "",
                  {"Verdict", "Check", "Run", "Pass", page.Named(">MD"), ">Value", ">Sigma",
                   ">Limit", "Unit", "Limit from, or why not done"});
  constexpr std::array kOrder = {"fail", "warn", "pass", "not_done"};
  for (const std::string_view wanted : kOrder) {
    for (std::size_t i = 0; i < checks.rows(); ++i) {
      if (checks.Text(i, "VERDICT") == wanted) WriteCheck(page, table, checks, i);
    }
  }
  for (std::size_t i = 0; i < checks.rows(); ++i) {
    const std::string verdict = checks.Text(i, "VERDICT");
    bool known = false;
    for (const std::string_view wanted : kOrder) known = known || verdict == wanted;
    if (!known) WriteCheck(page, table, checks, i);
  }
}

}  // namespace

void WriteChecks(PageText& page) {
  BeginBlock(page, 6, "Checks");
  const Columns checks(At(page.survey, {"checks"}));
  if (checks.rows() == 0) {
    SayNotMeasured(page, "Checks");
  } else {
    WriteAllChecks(page, checks);
  }
  EndBlock(page);
}

void WriteDiagnosis(PageText& page) {
  BeginBlock(page, 7, "Diagnosis and reliability");
  for (const auto& [member, caption, absent] :
       {std::array{"diagnosis", "What would explain the run, likeliest first", "Diagnosis"},
        std::array{"reliability",
                   "The smallest error of each kind that the checks would find, and what it would "
                   "do to the end of the well",
                   "Reliability"}}) {
    if (Columns(At(page.survey, {member})).rows() > 0) {
      WriteTable(page, At(page.survey, {member}), caption);
    } else {
      SayNotMeasured(page, absent);
    }
  }
  EndBlock(page);
}

}  // namespace wellgyro
