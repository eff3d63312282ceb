#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "wellgyro/io/plot/chart.h"
#include "wellgyro/io/result/json_columns_internal.h"
#include "wellgyro/page/report_page.h"

namespace wellgyro {

/// Lengths and curvatures as the page shows them.
struct PageUnits {
  double length = 1;  ///< of one metre
  std::string_view length_name = "m";
  double dogleg = 1;  ///< of one deg/30m
  std::string_view dogleg_name = "deg/30m";
};
/// Metres, or feet with doglegs in deg/100ft.
PageUnits UnitsOf(ReportOptions::Units units);

/// A page while it is written.
struct PageText {
  const Json& survey;  ///< the document
  PageUnits units;
  ReportOptions::Paper paper = ReportOptions::Paper::kA4;
  std::string html = {};
  Json charts = Json::array();  ///< what the script draws again

  std::string LengthName() const { return "[" + std::string(units.length_name) + "]"; }
  /// "MD [m]".
  std::string Named(std::string_view quantity) const;
  /// In the page's units; absent stays absent.
  std::optional<double> Length(const std::optional<double>& metres) const;
};

/// The member at the end of `path`; a null where one of them is missing.
const Json& At(const Json& object, std::initializer_list<std::string_view> path);
std::optional<double> NumberAt(const Json& object, std::initializer_list<std::string_view> path);
/// Text as it is, a number as it is written; empty where there is neither.
std::string TextAt(const Json& object, std::initializer_list<std::string_view> path);

/// "2026-01-01 00:00:09" UTC of microseconds since 1970; empty where there is none.
std::string TimeText(const std::optional<double>& utime_us);

/// A section with its number and heading.
void BeginBlock(PageText& page, int number, std::string_view heading);
void EndBlock(PageText& page);
/// A sentence that says that something is not there, and why where that is known.
void SayNotMeasured(PageText& page, std::string_view what);

/// Puts a chart into the page. `x_is_md`: its first axis is measured depth, so that the depth
/// cursor is a line in it.
void AddChart(PageText& page, std::string_view id, const Chart& chart, bool x_is_md);

// The blocks of the report, in their order.
void WriteVerdict(PageText& page);
void WriteHead(PageText& page);
void WriteMaps(PageText& page);
void WriteStops(PageText& page);
void WritePasses(PageText& page);
void WriteFits(PageText& page);
void WriteChecks(PageText& page);
void WriteDiagnosis(PageText& page);
void WriteListing(PageText& page);
void WriteSources(PageText& page);
void WritePlan(PageText& page);  ///< nothing where the document has no plan

}  // namespace wellgyro
