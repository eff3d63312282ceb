#include "wellgyro/io/exchange/witsml_text_internal.h"

#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/iso_time_internal.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro::witsml {

std::string Units::Name(Quantity quantity) const {
  switch (quantity) {
    case Quantity::kLength:
      return Length(head_.md_unit);
    case Quantity::kGridLength:
      return Length(head_.grid_unit);
    case Quantity::kAngle:
    case Quantity::kDirection:
      return "dega";
    case Quantity::kCurvature:
      return Curvature();
    case Quantity::kArea:
      return head_.md_unit == LengthUnit::kFoot ? "ft2" : "m2";
    case Quantity::kAcceleration:
      return "m/s2";
    case Quantity::kRate:
      return "dega/h";
    case Quantity::kTemperature:
      return "degC";
    case Quantity::kTime:
      return "s";
    default:
      return "";
  }
}

std::string Units::Text(Quantity quantity, double value) const {
  // There is no area in US survey feet.
  if (quantity == Quantity::kArea && head_.md_unit == LengthUnit::kUsFoot) return Exact(value);
  return Exact(quantity, value, head_);
}

std::string Units::Length(LengthUnit unit) const {
  if (unit == LengthUnit::kUsFoot) return version_2_ ? "ft[US]" : "ftUS";
  return std::string(WordOf(unit));
}

std::string Units::Curvature() const {
  switch (head_.curvature_unit) {
    case CurvatureUnit::kDegPer30m:
      return version_2_ ? "1/30 dega/m" : "dega/30m";
    case CurvatureUnit::kDegPer100ft:
      return version_2_ ? "0.01 dega/ft" : "dega/100ft";
    case CurvatureUnit::kDegPerMetre:
      return "dega/m";
    case CurvatureUnit::kDegPerFoot:
      return "dega/ft";
    default:
      return "rad/m";
  }
}

std::string UuidOf(const std::string& given, std::string_view what, const SurveyHead& head) {
  const auto hexadecimal = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
  };
  if (given.size() == 36 && given[8] == '-' && given[13] == '-' && given[18] == '-' &&
      given[23] == '-' && std::count_if(given.begin(), given.end(), hexadecimal) == 32) {
    return given;
  }
  std::string hash = Sha256Hex(fmt::format("{}\n{}\n{}\n{}\n{}", what, given, head.names.well,
                                           head.names.wellbore, head.names.survey));
  hash[12] = '8';
  hash[16] = '8';
  return fmt::format("{}-{}-{}-{}-{}", hash.substr(0, 8), hash.substr(8, 4), hash.substr(12, 4),
                     hash.substr(16, 4), hash.substr(20, 12));
}

std::string Or(const std::string& text, std::string_view otherwise) {
  return text.empty() ? std::string(otherwise) : text;
}

std::string Cut(const std::string& text, std::size_t characters) {
  std::size_t seen = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool begins = (static_cast<unsigned char>(text[i]) & 0xC0) != 0x80;
    if (begins && ++seen > characters) return text.substr(0, i);
  }
  return text;
}

std::string Uid(const std::string& text, std::string_view otherwise) {
  const std::string whole = Or(text, otherwise);
  std::string uid;
  for (const char c : whole) uid += c > ' ' && c < 0x7F && c != ',' ? c : '-';
  if (uid == whole && uid.size() <= kNameLength) return uid;
  return uid.substr(0, kNameLength - 9) + "-" + Sha256Hex(whole).substr(0, 8);
}

std::string DateTime(const std::string& text) {
  if (UtcOf(text)) return text;
  const std::string midnight = text + "T00:00:00.000Z";
  return UtcOf(midnight) ? midnight : std::string();
}

std::string Method(const std::string& method) {
  constexpr std::array<std::string_view, 8> kMethods{
      "average angle", "balanced tangential", "constant tool face",  "custom",
      "inertial",      "minimum curvature",   "radius of curvature", "tangential"};
  const std::string lower = Lower(method);
  return std::find(kMethods.begin(), kMethods.end(), lower) == kMethods.end() ? "" : lower;
}

std::string ToolText(SurveyTool tool) {
  return tool == SurveyTool::kInclinationOnly ? std::string() : std::string(WordOf(tool));
}

}  // namespace wellgyro::witsml
