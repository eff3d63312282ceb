// Block 10: the stops as they were planned, and as they were made.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <fmt/core.h>

#include "wellgyro/page/html_internal.h"
#include "wellgyro/page/page_internal.h"
#include "wellgyro/record/advice.h"

namespace wellgyro {
namespace {

/// A stop as it was made.
struct Stood {
  double md = 0;       ///< [m]
  double seconds = 0;  ///< used
  double begin = 0;    ///< [us]
};

std::vector<Stood> StopsOf(const Json& survey) {
  std::vector<Stood> stops;
  const Json& runs = At(survey, {"run", "run"});
  if (!runs.is_array()) return stops;
  for (const Json& run : runs) {
    const Json& fixes = At(run, {"north_fix"});
    if (!fixes.is_array()) continue;
    for (const Json& fix : fixes) {
      const auto md = NumberAt(fix, {"md_m"}), begin = NumberAt(fix, {"begin_utime_us"}),
                 end = NumberAt(fix, {"end_utime_us"});
      if (md && begin && end) stops.push_back({*md, 1e-6 * (*end - *begin), *begin});
    }
  }
  std::ranges::sort(stops, {}, &Stood::begin);
  return stops;
}

/// Of each planned stop the one made of it: as many in their order in time as lie within
/// Advice::kHere, the longest common subsequence. most(i, j) is its length from the i-th planned
/// and the j-th made on.
std::vector<std::optional<Stood>> Matched(const Json& planned, const std::vector<Stood>& stops) {
  const std::size_t rows = planned.size(), columns = stops.size();
  const auto same = [&](std::size_t i, std::size_t j) {
    return std::abs(stops[j].md - NumberAt(planned[i], {"md_m"}).value_or(NAN)) <= Advice::kHere;
  };
  Eigen::ArrayXXi most = Eigen::ArrayXXi::Zero(static_cast<Eigen::Index>(rows + 1),
                                               static_cast<Eigen::Index>(columns + 1));
  const auto at = [&most](std::size_t i, std::size_t j) -> int& {
    return most(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  };
  for (std::size_t i = rows; i-- > 0;) {
    for (std::size_t j = columns; j-- > 0;) {
      at(i, j) = same(i, j) ? at(i + 1, j + 1) + 1 : std::max(at(i + 1, j), at(i, j + 1));
    }
  }
  std::vector<std::optional<Stood>> matched(rows);
  for (std::size_t i = 0, j = 0; i < rows && j < columns;) {
    if (same(i, j)) {
      matched[i++] = stops[j++];
    } else {
      ++(at(i + 1, j) >= at(i, j + 1) ? i : j);
    }
  }
  return matched;
}

void WriteStopTable(PageText& page, const Json& planned,
                    const std::vector<std::optional<Stood>>& matched) {
  HtmlTable table(
      page.html, "planned-stops",
      fmt::format("Stops as planned, and those within {:.0f} m of them", Advice::kHere),
      {"Way", page.Named(">Planned MD"), ">Planned [s]", ">Toolface [\u00b0]",
       ">Ellipse without it " + page.LengthName(), page.Named(">Stood at MD"), ">Used [s]", ""});
  for (std::size_t i = 0; i < matched.size(); ++i) {
    const Json& stop = planned[i];
    const auto& stood = matched[i];
    table.Row(stood ? "" : "warn")
        .Text(TextAt(stop, {"pass"}))
        .Number(page.Length(NumberAt(stop, {"md_m"})), 1)
        .Number(NumberAt(stop, {"stop_s"}), 0)
        .Number(NumberAt(stop, {"toolface_deg"}), 0)
        .Number(page.Length(NumberAt(stop, {"ellipse_without_m"})), 2)
        .Number(page.Length(stood ? std::optional(stood->md) : std::nullopt), 1)
        .Number(stood ? std::optional(stood->seconds) : std::nullopt, 0)
        .Text(stood ? "made" : "not made");
  }
}

void WriteKept(PageText& page, const Json& plan, const std::vector<Stood>& stops) {
  double stood = 0;
  for (const Stood& stop : stops) stood += stop.seconds;
  HtmlTable table(page.html, "kept", "", {"What", ">Limit", ">Planned", ">Come to"});
  table.Row()
      .Text("95 % ellipse at the end, half axis " + page.LengthName())
      .Number(page.Length(NumberAt(plan, {"limits", "ellipse_m"})), 2)
      .Number(page.Length(NumberAt(plan, {"expected", "ellipse_major_m"})), 2)
      .Number(page.Length(NumberAt(page.survey, {"end", "ellipse", "semi_major_m"})), 2);
  table.Row()
      .Text("Stops")
      .Text("")
      .Number(static_cast<double>(At(plan, {"stop"}).size()), 0)
      .Number(static_cast<double>(stops.size()), 0);
  table.Row()
      .Text("Time at rest [s]")
      .Text("")
      .Number(NumberAt(plan, {"time", "at_rest_s"}), 0)
      .Number(stood, 0);
}

}  // namespace

void WritePlan(PageText& page) {
  const Json& plan = At(page.survey, {"plan"});
  if (!plan.is_object()) return;
  BeginBlock(page, 10, "The plan of the stops");
  const Json& planned = At(plan, {"stop"});
  const std::vector<Stood> stops = StopsOf(page.survey);
  WriteKept(page, plan, stops);
  if (planned.is_array() && !planned.empty()) {
    WriteStopTable(page, planned, Matched(planned, stops));
  } else {
    page.html += "<p>The plan has no stop.</p>\n";
  }
  page.html +=
      "<p>Time used is what a stop's north rests on: the tool stands some seconds longer.</p>\n";
  EndBlock(page);
}

}  // namespace wellgyro
