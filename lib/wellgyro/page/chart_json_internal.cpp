// Charts as the page's script reads them, beside their pictures.
#include <cmath>
#include <cstdlib>

#include <fmt/core.h>

#include "wellgyro/page/html_internal.h"
#include "wellgyro/page/page_internal.h"

namespace wellgyro {
namespace {

/// In seven digits: more than any screen tells apart.
Json Short(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.7g}", value).c_str(), nullptr);
}

const char* WordOf(ChartSeries::Mark mark) {
  switch (mark) {
    case ChartSeries::Mark::kLine:
      return "line";
    case ChartSeries::Mark::kDash:
      return "dash";
    case ChartSeries::Mark::kDots:
      return "dots";
    case ChartSeries::Mark::kArea:
      return "area";
    case ChartSeries::Mark::kFlag:
      return "flag";
  }
  return "line";
}

Json SeriesJson(const ChartSeries& series) {
  Json x = Json::array(), y = Json::array(), md = Json::array();
  for (const Eigen::Vector2d& point : series.points) {
    x.push_back(Short(point.x()));
    y.push_back(Short(point.y()));
  }
  for (const double depth : series.md) md.push_back(Short(depth));
  return {{"name", series.name},
          {"mark", WordOf(series.mark)},
          {"colour", ChartColour(series.colour)},
          {"x", x},
          {"y", y},
          {"md", md}};
}

}  // namespace

void AddChart(PageText& page, std::string_view id, const Chart& chart, bool x_is_md) {
  const ChartFrame frame = FrameOf(chart);
  Json json{{"id", id},          {"title", chart.title}, {"x", chart.x_name},
            {"y", chart.y_name}, {"down", chart.y_down}, {"equal", chart.equal},
            {"md", x_is_md},     {"width", chart.width}, {"height", chart.height}};
  json["low"] = {frame.low.x(), frame.low.y()};
  json["high"] = {frame.high.x(), frame.high.y()};
  json["series"] = Json::array();
  for (const ChartSeries& series : chart.series) json["series"].push_back(SeriesJson(series));
  json["notes"] = Json::array();
  for (const ChartNote& note : chart.notes) {
    json["notes"].push_back(
        {{"x", Short(note.at.x())}, {"y", Short(note.at.y())}, {"text", note.text}});
  }
  page.charts.push_back(std::move(json));
  page.html += fmt::format("<figure class=\"chart\" id=\"{}\" tabindex=\"0\">{}</figure>\n",
                           Escaped(id), ChartSvg(chart));
}

}  // namespace wellgyro
