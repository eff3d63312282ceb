// Block 3: what the sensors read at rest, against what they should.
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/page/html_internal.h"
#include "wellgyro/page/page_internal.h"

namespace wellgyro {
namespace {

std::string WithSigma(const Json& fix, std::string_view value, std::string_view sigma,
                      int decimals) {
  const auto number = NumberAt(fix, {value}), spread = NumberAt(fix, {sigma});
  std::string text = NumberText(number, decimals);
  if (number && spread) text += " \u00b1 " + NumberText(spread, decimals);
  return text;
}

std::optional<double> Difference(const Json& fix, std::string_view value,
                                 std::string_view reference) {
  const auto found = NumberAt(fix, {value}), wanted = NumberAt(fix, {reference});
  if (!found || !wanted) return std::nullopt;
  return *found - *wanted;
}

void WriteFixRow(const PageText& page, HtmlTable& table, const Json& run, const Json& fix) {
  const auto begin = NumberAt(fix, {"begin_utime_us"}), end = NumberAt(fix, {"end_utime_us"});
  const auto gravity = Difference(fix, "gravity_mps2", "gravity_ref_mps2");
  const bool external = At(fix, {"external"}) == true;
  table.Row()
      .Text(TextAt(run, {"number"}))
      .Number(page.Length(NumberAt(fix, {"md_m"})), 2)
      .Text(TimeText(begin))
      .Number(begin && end ? std::optional((*end - *begin) / 1e6) : std::nullopt, 0)
      .Cell(WithSigma(fix, "inclination_deg", "sigma_inclination_deg", 3))
      .Cell(WithSigma(fix, "azimuth_true_deg", "sigma_azimuth_deg", 2))
      .Text(external ? "given" : "found")
      .Number(gravity ? std::optional(1e3 * *gravity) : std::nullopt, 2)
      .Number(Difference(fix, "earth_rate_deg_per_h", "earth_rate_ref_deg_per_h"), 3)
      .Cell(WithSigma(fix, "closure_deg", "sigma_closure_deg", 2))
      .Cell(WithSigma(fix, "gyro_bias_x_deg_per_h", "sigma_gyro_bias_x_deg_per_h", 3))
      .Cell(WithSigma(fix, "gyro_bias_y_deg_per_h", "sigma_gyro_bias_y_deg_per_h", 3))
      .Cell(WithSigma(fix, "roll_rate_deg_per_h", "sigma_roll_rate_deg_per_h", 3))
      .Text(TextAt(fix, {"quality"}));
}

/// Values of one check at the stops, with its limits on both sides.
void AddCheckChart(PageText& page, const Columns& checks, std::string_view code, double unit,
                   const char* title, const char* y_name) {
  Chart chart{.title = title, .x_name = page.Named("MD"), .y_name = y_name, .height = 200};
  ChartSeries values{.name = "measured less reference", .mark = ChartSeries::Mark::kDots},
      above{.name = "limit", .mark = ChartSeries::Mark::kDots, .colour = 1},
      below = above,
      failed{.name = "beyond its limit", .mark = ChartSeries::Mark::kFlag, .colour = 1};
  for (std::size_t i = 0; i < checks.rows(); ++i) {
    if (checks.Text(i, "CODE") != code) continue;
    const auto md = page.Length(checks.Number(i, "MD[m]")), value = checks.Number(i, "VALUE"),
               limit = checks.Number(i, "LIMIT");
    if (!md || !value) continue;
    const Eigen::Vector2d at(*md, unit * *value);
    values.points.push_back(at);
    values.md.push_back(*md);
    if (checks.Text(i, "VERDICT") == "fail") failed.points.push_back(at);
    if (!limit) continue;
    above.points.emplace_back(*md, unit * *limit);
    below.points.emplace_back(*md, -unit * *limit);
  }
  chart.series = {std::move(values), std::move(above), std::move(below)};
  if (!failed.points.empty()) chart.series.push_back(std::move(failed));
  AddChart(page, fmt::format("stop-{}", code), chart, true);
}

}  // namespace

void WriteStops(PageText& page) {
  BeginBlock(page, 3, "Stops");
  const Json& runs = At(page.survey, {"run", "run"});
  bool any = false;
  if (runs.is_array()) {
    for (const Json& run : runs) any = any || At(run, {"north_fix"}).is_array();
  }
  if (!any) {
    SayNotMeasured(page, "North at rest");
    return EndBlock(page);
  }
  {
    HtmlTable table(
        page.html, "stops", "North fixes, \u00b1 one sigma",
        {"Run", page.Named(">MD"), "Begin [UTC]", ">Time used [s]", "Inclination [\u00b0]",
         "Azimuth true [\u00b0]", "North", ">Gravity less reference [mm/s\u00b2]",
         ">Earth rate less reference [\u00b0/h]", "Azimuth closure [\u00b0]", "Bias x [\u00b0/h]",
         "Bias y [\u00b0/h]", "Roll [\u00b0/h]", "Quality"});
    for (const Json& run : runs) {
      const Json& fixes = At(run, {"north_fix"});
      if (!fixes.is_array()) continue;
      for (const Json& fix : fixes) WriteFixRow(page, table, run, fix);
    }
  }
  const Columns checks(At(page.survey, {"checks"}));
  AddCheckChart(page, checks, "gravity", 1e3, "Gravity at rest, measured less reference",
                "[mm/s\u00b2]");
  AddCheckChart(page, checks, "earth_rate", 1, "Earth rate at rest, measured less reference",
                "[\u00b0/h]");
  page.html +=
      "<p>A bias is found where the stop alone tells it (index positions); limits are those of "
      "block "
      "6.</p>\n";
  EndBlock(page);
}

}  // namespace wellgyro
