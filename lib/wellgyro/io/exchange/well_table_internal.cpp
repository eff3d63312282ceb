#include "wellgyro/io/exchange/well_table_internal.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

constexpr std::string_view kHead = "MD[m],INC[deg],AZI_TRUE[deg]";

std::optional<std::array<double, 3>> ThreeNumbers(std::string_view line) {
  std::array<double, 3> v{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::string_view field = line.substr(0, line.find(','));
    const std::optional<double> number = NumberOf(field);
    if (!number) return std::nullopt;
    v[i] = *number;
    line.remove_prefix(std::min(field.size() + 1, line.size()));
  }
  return v;
}

}  // namespace

Result<std::vector<WellPoint>> ParseWellTable(std::string_view text, const std::string& source) {
  std::vector<WellPoint> points;
  int line_number = 0;
  const auto fault = [&](FaultCode code, std::string why) {
    return Fault{.code = code, .text = std::move(why), .source = source, .line = line_number};
  };
  while (!text.empty() || line_number == 0) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (++line_number == 1) {
      if (line.starts_with(kHead)) continue;
      return fault(FaultCode::kForeign,
                   fmt::format("its first line does not begin with {}", kHead));
    }
    const auto v = ThreeNumbers(line);
    if (!v) return fault(FaultCode::kSyntax, "does not begin with three numbers");
    const auto [md, inclination, azimuth] = *v;
    if (inclination < 0 || inclination > 180) {
      return fault(FaultCode::kRange, fmt::format("{} is no inclination", inclination));
    }
    if (!points.empty() && !(md > points.back().md)) {
      return fault(FaultCode::kOrder, fmt::format("depth {} after {}", md, points.back().md));
    }
    points.push_back({.md = md,
                      .inclination = FromDegrees(inclination),
                      .azimuth = WrapTwoPi(FromDegrees(azimuth))});
  }
  if (points.size() < 2) return fault(FaultCode::kRange, "a well needs two stations");
  return points;
}

}  // namespace wellgyro
