// Block 4: the passes of a run against each other, and what depth came to.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/page/html_internal.h"
#include "wellgyro/page/page_internal.h"
#include "wellgyro/survey/hole/field_practice.h"

namespace wellgyro {
namespace {

namespace practice = field_practice;

using Mark = ChartSeries::Mark;

constexpr double kModelSigmas = 3;  // as Compare() of checks: P(|x| > 3) = 0.27 % of each depth
// Of inclination, below which an azimuth is none: 1 / sin 2 deg = 29 times as vague as a direction.
constexpr double kLeastDeg = 2;
constexpr std::size_t kListed = 60;  // depths in the table of what is beyond

struct Compared {
  double md = 0, inclination = 0, difference = 0, practice = 0;
  std::optional<double> model;
  bool beyond_model() const { return model && std::abs(difference) > *model; }
  bool beyond_practice() const { return std::abs(difference) > practice; }
  /// Beyond what the run's own sigmas allow; where it has none, beyond field practice.
  bool flagged() const { return model ? beyond_model() : beyond_practice(); }
};

std::vector<Compared> Of(const PageText& page, const Columns& rows, bool azimuth) {
  std::vector<Compared> list;
  for (std::size_t i = 0; i < rows.rows(); ++i) {
    const auto md = page.Length(rows.Number(i, "MD[m]")), inclination = rows.Number(i, "INC[deg]"),
               difference = rows.Number(i, azimuth ? "D_AZI[deg]" : "D_INC[deg]"),
               sigma = rows.Number(i, azimuth ? "SIG_D_AZI[deg]" : "SIG_D_INC[deg]");
    if (!md || !inclination || !difference) continue;
    if (azimuth && *inclination < kLeastDeg) continue;
    Compared one{.md = *md, .inclination = *inclination, .difference = *difference};
    one.practice = !azimuth                             ? practice::kInclinationDeg
                   : *inclination < practice::kSteepDeg ? practice::kLowAzimuthDeg
                                                        : practice::kAzimuthDeg;
    if (sigma) one.model = kModelSigmas * *sigma;
    list.push_back(one);
  }
  return list;
}

/// One of the limits on both sides, as far as `reach`: what leaves the frame is said in the legend.
void AddLimits(Chart& chart, const std::vector<Compared>& list, const std::string& name, bool model,
               double reach) {
  ChartSeries above{
      .name = name, .mark = model ? Mark::kLine : Mark::kDash, .colour = model ? 2 : 1};
  bool seen = false;
  for (const Compared& one : list) {
    const double limit = model ? one.model.value_or(NAN) : one.practice;
    const bool inside = limit <= reach;
    seen = seen || inside;
    above.points.emplace_back(one.md, inside ? limit : NAN);
  }
  if (!seen) above.name += ", beyond the frame";
  ChartSeries below = above;
  for (Eigen::Vector2d& point : below.points) point.y() = -point.y();
  below.name.clear();
  chart.series.push_back(std::move(above));
  chart.series.push_back(std::move(below));
}

/// How far limits are shown: what the differences themselves ask for, and a tenth of the limit of
/// field practice where they are less.
double ReachOf(const std::vector<Compared>& list) {
  double most = 0, practice = 1e9;
  for (const Compared& one : list) {
    most = std::max(most, std::abs(one.difference));
    practice = std::min(practice, one.practice);
  }
  return std::max(2 * most, 0.1 * practice);
}

void AddDifferences(PageText& page, const std::string& id, const std::string& title,
                    const std::string& practice, const std::vector<Compared>& list) {
  Chart chart{.title = title, .x_name = page.Named("MD"), .y_name = "[\u00b0]", .height = 230};
  ChartSeries line{.name = "difference"},
      flags{.name = "beyond, see the table", .mark = Mark::kFlag, .colour = 1};
  for (const Compared& one : list) {
    line.points.emplace_back(one.md, one.difference);
    line.md.push_back(one.md);
    if (one.flagged()) flags.points.push_back(line.points.back());
  }
  const double reach = ReachOf(list);
  AddLimits(chart, list, "3 sigma of both passes", true, reach);
  AddLimits(chart, list, practice, false, reach);
  chart.series.push_back(std::move(line));
  if (!flags.points.empty()) chart.series.push_back(std::move(flags));
  AddChart(page, id, chart, true);
}

void WriteSummary(HtmlTable& table, const char* what, const std::vector<Compared>& list) {
  double sum = 0, squares = 0;
  const Compared* worst = nullptr;
  for (const Compared& one : list) {
    sum += one.difference;
    squares += one.difference * one.difference;
    if (!worst || std::abs(one.difference) > std::abs(worst->difference)) worst = &one;
  }
  const auto count = static_cast<double>(list.size());
  const auto beyond = [&](auto test) {
    return std::optional(static_cast<double>(std::ranges::count_if(list, test)));
  };
  table.Row().Text(what).Number(count, 0);
  if (!worst) {
    for (int i = 0; i < 6; ++i) table.Number(std::nullopt, 0);
    return;
  }
  table.Number(sum / count, 4)
      .Number(std::sqrt(squares / count), 4)
      .Number(worst->difference, 4)
      .Number(worst->md, 2)
      .Number(beyond([](const Compared& one) { return one.beyond_model(); }), 0)
      .Number(beyond([](const Compared& one) { return one.beyond_practice(); }), 0);
}

void WriteBeyond(PageText& page,
                 const std::array<std::pair<const char*, std::vector<Compared>>, 2>& both) {
  std::size_t found = 0;
  for (const auto& [what, list] : both) {
    found += static_cast<std::size_t>(std::ranges::count_if(list, &Compared::flagged));
  }
  if (found == 0) {
    page.html += "<p>No difference is beyond the limits.</p>\n";
    return;
  }
  HtmlTable table(page.html, "beyond",
                  fmt::format("Beyond the limits: {} depths{}", found,
                              found > kListed ? fmt::format(", the first {}", kListed) : ""),
                  {"Of", page.Named(">MD"), ">Inclination [\u00b0]", ">Difference [\u00b0]",
                   ">3 sigma [\u00b0]", ">Field practice [\u00b0]"});
  std::size_t listed = 0;
  for (const auto& [what, list] : both) {
    for (const Compared& one : list) {
      if (!one.flagged() || ++listed > kListed) continue;
      table.Row(one.beyond_practice() ? "fail" : "warn")
          .Text(what)
          .Number(one.md, 2)
          .Number(one.inclination, 2)
          .Number(one.difference, 4)
          .Number(one.model, 4)
          .Number(one.practice, 2);
    }
  }
}

void WritePair(PageText& page, const Json& pair) {
  const std::string run = NumberText(NumberAt(pair, {"run"}), 0), other = TextAt(pair, {"other"}),
                    first = TextAt(pair, {"first"});
  const Columns rows(pair);
  const std::array both{std::pair("inclination", Of(page, rows, false)),
                        std::pair("azimuth", Of(page, rows, true))};
  page.html +=
      fmt::format("<h3>Run {}, pass {} less pass {}</h3>\n", run, Escaped(other), Escaped(first));
  const std::array limits{
      fmt::format("field practice {:g}\u00b0", practice::kInclinationDeg),
      fmt::format("field practice {:g}\u00b0, {:g}\u00b0 below {:g}\u00b0", practice::kAzimuthDeg,
                  practice::kLowAzimuthDeg, practice::kSteepDeg)};
  for (std::size_t i = 0; i < both.size(); ++i) {
    const auto& [what, list] = both[i];
    AddDifferences(page, fmt::format("run-{}-{}-{}", run, other, what),
                   fmt::format("Run {}: {}, {} less {}", run, what, other, first), limits[i], list);
  }
  {
    HtmlTable table(
        page.html, "summary", "",
        {"Of", ">Depths compared", ">Mean [\u00b0]", ">Rms [\u00b0]", ">Largest [\u00b0]",
         ">at " + page.Named("MD"), ">Beyond 3 sigma", ">Beyond field practice"});
    for (const auto& [what, list] : both) WriteSummary(table, what, list);
  }
  if (std::ssize(both[0].second) < practice::kDepths) {
    page.html +=
        fmt::format("<p>Field practice asks for {} depths at least.</p>\n", practice::kDepths);
  }
  WriteBeyond(page, both);
}

/// Inclination or azimuth along the hole, a series a pass.
void AddAngles(PageText& page, const char* id, const char* title, const char* column, bool dots) {
  const Columns passes(At(page.survey, {"passes"}));
  std::map<std::string, ChartSeries> by_pass;
  for (std::size_t i = 0; i < passes.rows(); ++i) {
    const auto md = page.Length(passes.Number(i, "MD[m]")), angle = passes.Number(i, column);
    const auto run = passes.Number(i, "RUN"), inclination = passes.Number(i, "INC[deg]");
    if (!md || !angle || !run || !inclination || (dots && *inclination < kLeastDeg)) continue;
    const std::string name = fmt::format("run {:.0f} {}", *run, passes.Text(i, "PASS"));
    auto [series, fresh] = by_pass.try_emplace(name);
    if (fresh)
      series->second = {.name = name,
                        .mark = dots ? Mark::kDots : Mark::kLine,
                        .colour = static_cast<int>(by_pass.size()) - 1};
    series->second.points.emplace_back(*md, *angle);
    series->second.md.push_back(*md);
  }
  Chart chart{.title = title, .x_name = page.Named("MD"), .y_name = "[\u00b0]", .height = 220};
  for (auto& [name, series] : by_pass) {
    const bool stop = name.ends_with("stationary");
    if (stop) series.mark = Mark::kDots;
    chart.series.push_back(std::move(series));
  }
  AddChart(page, id, chart, true);
}

/// Nothing of checks of the whole job.
std::optional<double> RunOf(const Columns& checks, std::size_t row) {
  const auto run = checks.Number(row, "RUN");
  return run && *run > 0 ? run : std::nullopt;
}

void WriteDepth(PageText& page) {
  page.html += "<h3>Depth</h3>\n";
  const Columns checks(At(page.survey, {"checks"}));
  HtmlTable table(
      page.html, "depth", "",
      {"Check", ">Run", page.Named(">MD"), ">Value", ">Limit", "Unit", "Limit from", "Verdict"});
  constexpr std::array kCodes = {"depth_closure", "depth_slippage",   "magnetic_marks",
                                 "depth_scale",   "depth_scale_felt", "depth_jump",
                                 "depth_lag",     "depth_unknown",    "depth_without_station",
                                 "depth_refused"};
  for (const char* code : kCodes) {
    bool found = false;
    for (std::size_t i = 0; i < checks.rows(); ++i) {
      if (checks.Text(i, "CODE") != code) continue;
      found = true;
      table.Row(checks.Text(i, "VERDICT"))
          .Text(code)
          .Number(RunOf(checks, i), 0)
          .Number(page.Length(checks.Number(i, "MD[m]")), 2)
          .Short(checks.Number(i, "VALUE"))
          .Short(checks.Number(i, "LIMIT"))
          .Text(checks.Text(i, "UNIT"))
          .Text(checks.Text(i, "LIMIT_SOURCE"))
          .Text(checks.Text(i, "VERDICT") == "not_done" ? "not done" : checks.Text(i, "VERDICT"));
    }
    if (!found)
      table.Row("not_done")
          .Text(code)
          .Text("")
          .Text("")
          .Text("")
          .Text("")
          .Text("")
          .Text("")
          .Text("not measured");
  }
}

}  // namespace

void WritePasses(PageText& page) {
  BeginBlock(page, 4, "In-run against out-run");
  if (Columns(At(page.survey, {"passes"})).rows() > 0) {
    AddAngles(page, "inclination", "Inclination along the hole", "INC[deg]", false);
    AddAngles(page, "azimuth", "Azimuth (true) along the hole", "AZI_TRUE[deg]", true);
  }
  const Json& pairs = At(page.survey, {"pass_differences"});
  if (!pairs.is_array() || pairs.empty()) {
    SayNotMeasured(page, "A second pass over the same depths");
  } else {
    for (const Json& pair : pairs) WritePair(page, pair);
    page.html +=
        "<p>3 sigma is that of both passes as if they were independent: what errs alike in both "
        "cancels "
        "in the difference and stands in it twice. Azimuths are compared from 2\u00b0 of "
        "inclination on. "
        "Field practice: inclination 0.23\u00b0, azimuth 1\u00b0, below 10\u00b0 of inclination "
        "5\u00b0.</p>\n";
  }
  WriteDepth(page);
  EndBlock(page);
}

}  // namespace wellgyro
