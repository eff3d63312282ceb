#include "wellgyro/page/page_internal.h"

#include <cmath>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/iso_time_internal.h"
#include "wellgyro/page/html_internal.h"

namespace wellgyro {

PageUnits UnitsOf(ReportOptions::Units units) {
  if (units == ReportOptions::Units::kMetric) return {};
  return {1 / units::kFoot, "ft", 100 * units::kFoot / 30, "deg/100ft"};
}

std::string PageText::Named(std::string_view quantity) const {
  return std::string(quantity) + ' ' + LengthName();
}

std::optional<double> PageText::Length(const std::optional<double>& metres) const {
  return metres ? std::optional(*metres * units.length) : std::nullopt;
}

const Json& At(const Json& object, std::initializer_list<std::string_view> path) {
  static const Json kNull;
  const Json* at = &object;
  for (const std::string_view key : path) {
    if (!at->is_object()) return kNull;
    const auto member = at->find(std::string(key));
    if (member == at->end()) return kNull;
    at = &*member;
  }
  return *at;
}

std::optional<double> NumberAt(const Json& object, std::initializer_list<std::string_view> path) {
  const Json& value = At(object, path);
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

std::string TextAt(const Json& object, std::initializer_list<std::string_view> path) {
  const Json& value = At(object, path);
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number() || value.is_boolean()) return value.dump();
  return {};
}

std::string TimeText(const std::optional<double>& utime_us) {
  constexpr double kLatest = 253402300799e6;  // the last second of the year 9999
  if (!utime_us || !(std::abs(*utime_us) < kLatest)) return {};
  std::string text = IsoUtc(std::floor(*utime_us / 1e6)).substr(0, 19);
  if (text.size() > 10) text[10] = ' ';
  return text;
}

void BeginBlock(PageText& page, int number, std::string_view heading) {
  page.html += fmt::format("<section id=\"block-{0}\"><h2>{0}. {1}</h2>\n", number, heading);
}

void EndBlock(PageText& page) { page.html += "</section>\n"; }

void SayNotMeasured(PageText& page, std::string_view what) {
  page.html += fmt::format("<p class=\"absent\">{}: not measured.</p>\n", Escaped(what));
}

}  // namespace wellgyro
