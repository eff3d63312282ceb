#include "wellgyro/io/exchange/p717_record_internal.h"

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/column_units_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro::p717 {
namespace {

// The drafts of 2018 have the tool after n, e, d; that of 2019 has it before MD. Whole numbers tell
// them apart, or the absence of n, e and d.
bool ToolBeforeDepth(const Record& r) {
  return IntegerOf(r.At(6)).has_value() && !IntegerOf(r.At(12)).has_value();
}

}  // namespace

void Record::Take(std::string_view line) { Split(line, ',', fields_); }

std::optional<double> Record::Maybe(std::size_t i, double factor) const {
  const std::string_view text = At(i);
  if (text.empty() || text == "N/A") return std::nullopt;
  const auto number = NumberOf(text);
  if (!number) Odd(i, "is not a number");
  return *number * factor;
}

double Record::Needed(std::size_t i, double factor) const {
  const auto value = Maybe(i, factor);
  if (!value) Odd(i, "is missing");
  return *value;
}

int Record::Integer(std::size_t i, int otherwise) const {
  if (At(i).empty()) return otherwise;
  const auto number = IntegerOf(At(i));
  if (!number) Odd(i, "is not a whole number");
  return *number;
}

void Record::Odd(std::size_t i, std::string_view why) const {
  lines_.Complain(FaultCode::kSyntax,
                  fmt::format("field {} '{}' {}", i + 1, At(i).substr(0, 40), why),
                  static_cast<int>(i) + 1);
}

GyroRawRecord GyroRawOf(const Record& r, double md_unit) {
  const bool tool_first = ToolBeforeDepth(r);
  const std::size_t md = tool_first ? 7 : 6;
  GyroRawRecord g;
  g.survey = r.Integer(2, 1);
  g.number = r.Integer(3, 0);
  g.time = r.Text(4);
  g.used = r.Integer(tool_first ? 6 : 5, 1) != 0;
  g.tool = r.Integer(tool_first ? 5 : 12, 1);
  g.md = r.Needed(md, md_unit);
  g.inclination = r.Needed(md + 1, units::kDeg);
  g.azimuth = ValueOf(Quantity::kDirection, r.Needed(md + 2, 1), units::kDeg);
  g.north = r.Maybe(md + 3, md_unit);
  g.east = r.Maybe(md + 4, md_unit);
  g.down = r.Maybe(md + 5, md_unit);
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    g.f[k] = r.Needed(13 + i, 1);
    g.w[k] = r.Needed(16 + i, units::kDegPerHour);
  }
  g.gravity = r.Maybe(19, 1);
  g.latitude = r.Maybe(20, units::kDeg);
  g.earth_rate = r.Maybe(21, units::kDegPerHour);
  g.gyro_toolface = r.Maybe(22, units::kDeg);
  g.gravity_toolface = r.Maybe(23, units::kDeg);
  g.gravity_ref = r.Maybe(24, 1);
  g.latitude_ref = r.Maybe(25, units::kDeg);
  g.earth_rate_ref = r.Maybe(26, units::kDegPerHour);
  g.convergence = r.Maybe(27, units::kDeg);
  return g;
}

}  // namespace wellgyro::p717
