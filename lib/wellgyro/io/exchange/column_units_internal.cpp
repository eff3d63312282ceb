#include "wellgyro/io/exchange/column_units_internal.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

using Q = Quantity;

struct LengthName {
  LengthUnit unit;
  std::string_view word;
  double factor;
};
constexpr std::array kLengths{
    LengthName{LengthUnit::kMetre, "m", 1},
    LengthName{LengthUnit::kFoot, "ft", units::kFoot},
    LengthName{LengthUnit::kUsFoot, "ftUS", units::kUsSurveyFoot},
};

struct CurvatureName {
  CurvatureUnit unit;
  std::string_view word;
  double factor;
};
constexpr std::array kCurvatures{
    CurvatureName{CurvatureUnit::kDegPer30m, "deg/30m", units::kDegPer30m},
    CurvatureName{CurvatureUnit::kDegPer100ft, "deg/100ft", units::kDegPer100ft},
    CurvatureName{CurvatureUnit::kDegPerMetre, "deg/m", units::kDeg},
    CurvatureName{CurvatureUnit::kDegPerFoot, "deg/ft", units::kDeg / units::kFoot},
    CurvatureName{CurvatureUnit::kRadPerMetre, "rad/m", 1},
};

// Names as WithoutBlanks leaves them.
struct LengthAlias {
  std::string_view name;
  LengthUnit unit;
};
constexpr std::array kLengthAliases{
    LengthAlias{"m", LengthUnit::kMetre},
    LengthAlias{"metre", LengthUnit::kMetre},
    LengthAlias{"metres", LengthUnit::kMetre},
    LengthAlias{"meter", LengthUnit::kMetre},
    LengthAlias{"meters", LengthUnit::kMetre},
    LengthAlias{"mtr", LengthUnit::kMetre},
    LengthAlias{"ft", LengthUnit::kFoot},
    LengthAlias{"f", LengthUnit::kFoot},
    LengthAlias{"foot", LengthUnit::kFoot},
    LengthAlias{"feet", LengthUnit::kFoot},
    LengthAlias{"ftus", LengthUnit::kUsFoot},
    LengthAlias{"usft", LengthUnit::kUsFoot},
    LengthAlias{"ft[us]", LengthUnit::kUsFoot},
    LengthAlias{"ussurveyfoot", LengthUnit::kUsFoot},
    LengthAlias{"ussurveyfeet", LengthUnit::kUsFoot},
};

struct UnitName {
  Quantity quantity;
  std::string_view name;
  double factor;
};
constexpr std::array kUnitNames{
    UnitName{Q::kLength, "cm", 0.01},
    UnitName{Q::kLength, "mm", 0.001},
    UnitName{Q::kLength, "km", 1000},
    UnitName{Q::kLength, "in", 0.0254},
    UnitName{Q::kAngle, "deg", units::kDeg},
    UnitName{Q::kAngle, "dega", units::kDeg},
    UnitName{Q::kAngle, "degree", units::kDeg},
    UnitName{Q::kAngle, "degrees", units::kDeg},
    UnitName{Q::kAngle, "dg", units::kDeg},
    UnitName{Q::kAngle, "\xC2\xB0", units::kDeg},
    UnitName{Q::kAngle, "rad", 1},
    UnitName{Q::kAngle, "radians", 1},
    UnitName{Q::kAngle, "gon", kPi / 200},
    UnitName{Q::kAngle, "grad", kPi / 200},
    UnitName{Q::kAcceleration, "m/s2", 1},
    UnitName{Q::kAcceleration, "ft/s2", units::kFoot},
    UnitName{Q::kAcceleration, "g", units::kStandardGravity},
    UnitName{Q::kAcceleration, "gn", units::kStandardGravity},
    UnitName{Q::kAcceleration, "mg", units::kMilliG},
    UnitName{Q::kAcceleration, "mgn", units::kMilliG},
    UnitName{Q::kRate, "deg/h", units::kDegPerHour},
    UnitName{Q::kRate, "deg/hr", units::kDegPerHour},
    UnitName{Q::kRate, "dega/h", units::kDegPerHour},
    UnitName{Q::kRate, "deg/s", units::kDeg},
    UnitName{Q::kRate, "dega/s", units::kDeg},
    UnitName{Q::kRate, "rad/s", 1},
    UnitName{Q::kTemperature, "degc", 1},
    UnitName{Q::kTemperature, "c", 1},
    UnitName{Q::kTemperature,
             "\xC2\xB0"
             "c",
             1},
    UnitName{Q::kTime, "s", 1},
    UnitName{Q::kTime, "sec", 1},
    UnitName{Q::kRatio, "", 1},
    UnitName{Q::kRatio, "1", 1},
    UnitName{Q::kRatio, "-", 1},
};

// The quantity under which kUnitNames lists its units.
Quantity ListedAs(Quantity quantity) {
  switch (quantity) {
    case Q::kGridLength:
      return Q::kLength;
    case Q::kDirection:
      return Q::kAngle;
    case Q::kNumber:
      return Q::kRatio;
    default:
      return quantity;
  }
}

std::string WithoutBlanks(std::string_view text) {
  std::string kept;
  for (const char c : Lower(text)) {
    if (c != ' ' && c != '^' && c != '_') kept += c;
  }
  return kept;
}

// deg/30m, 1/30 dega/m, dega/100ft, rad/m ...
std::optional<double> CurvatureFactor(std::string unit) {
  double times = 1;
  for (const auto& [start, factor] : {std::pair<std::string_view, double>{"1/30", 1.0 / 30},
                                      std::pair<std::string_view, double>{"0.01", 0.01}}) {
    if (unit.starts_with(start)) {
      unit.erase(0, start.size());
      times = factor;
    }
  }
  const std::size_t slash = unit.find('/');
  if (slash == std::string::npos) return std::nullopt;
  const std::optional<double> angle = FactorOf(Quantity::kAngle, unit.substr(0, slash));
  std::string per = unit.substr(slash + 1);
  const std::size_t letters = std::min(per.find_first_not_of("0123456789."), per.size());
  const std::optional<double> count = letters == 0 ? 1 : NumberOf(per.substr(0, letters));
  const std::optional<LengthUnit> length = LengthUnitOf(per.substr(letters));
  if (!angle || !count || !length || !(*count > 0)) return std::nullopt;
  // The trade's own units by their own constants, so that they come back to the last bit.
  for (const CurvatureUnit known : {CurvatureUnit::kDegPer30m, CurvatureUnit::kDegPer100ft}) {
    const double factor = times * *angle / (*count * FactorOf(*length));
    if (std::abs(factor / FactorOf(known) - 1) < 1e-12) return FactorOf(known);
  }
  return times * *angle / (*count * FactorOf(*length));
}

std::optional<double> AreaFactor(std::string_view unit) {
  if (!unit.ends_with('2')) return std::nullopt;
  const auto length = LengthUnitOf(unit.substr(0, unit.size() - 1));
  if (!length) return std::nullopt;
  return FactorOf(*length) * FactorOf(*length);
}

}  // namespace

std::optional<LengthUnit> LengthUnitOf(std::string_view unit) {
  const std::string plain = WithoutBlanks(unit);
  for (const LengthAlias& alias : kLengthAliases) {
    if (alias.name == plain) return alias.unit;
  }
  return std::nullopt;
}

std::optional<double> FactorOf(Quantity quantity, std::string_view unit) {
  const std::string plain = WithoutBlanks(unit);
  quantity = ListedAs(quantity);
  if (quantity == Q::kCurvature) return CurvatureFactor(plain);
  if (quantity == Q::kArea) return AreaFactor(plain);
  if (quantity == Q::kLength) {
    if (const auto length = LengthUnitOf(plain)) return FactorOf(*length);
  }
  for (const UnitName& known : kUnitNames) {
    if (known.quantity == quantity && known.name == plain) return known.factor;
  }
  return std::nullopt;
}

std::optional<CurvatureUnit> CurvatureUnitOf(std::string_view unit) {
  const std::optional<double> factor = FactorOf(Quantity::kCurvature, unit);
  if (!factor) return std::nullopt;
  for (const CurvatureName& known : kCurvatures) {
    if (std::abs(*factor / known.factor - 1) < 1e-12) return known.unit;
  }
  return std::nullopt;
}

std::string NoUnit(Quantity quantity, std::string_view unit, std::string_view column) {
  quantity = ListedAs(quantity);
  std::string known;
  const auto add = [&known](std::string_view word) {
    const bool plain =
        std::all_of(word.begin(), word.end(), [](unsigned char c) { return c > ' ' && c < 0x7f; });
    if (plain && !word.empty()) known += (known.empty() ? "" : ", ") + std::string(word);
  };
  for (const LengthName& length : kLengths) {
    if (quantity == Q::kLength) add(length.word);
    if (quantity == Q::kArea) add(std::string(length.word) + '2');
  }
  for (const CurvatureName& curvature : kCurvatures) {
    if (quantity == Q::kCurvature) add(curvature.word);
  }
  for (const UnitName& one : kUnitNames) {
    if (one.quantity == quantity) add(one.name);
  }
  return fmt::format("'{}' is no unit of {}; known are {}", unit, column, known);
}

std::string NoUnitOfDepth(std::string_view unit) {
  std::string known;
  for (const LengthName& length : kLengths) {
    known += (known.empty() ? "" : ", ") + std::string(length.word);
  }
  return fmt::format("'{}' is no unit of measured depth; known are {}", unit, known);
}

double FactorOf(LengthUnit unit) { return kLengths[static_cast<std::size_t>(unit)].factor; }
double FactorOf(CurvatureUnit unit) { return kCurvatures[static_cast<std::size_t>(unit)].factor; }
std::string_view WordOf(LengthUnit unit) { return kLengths[static_cast<std::size_t>(unit)].word; }
std::string_view WordOf(CurvatureUnit unit) {
  return kCurvatures[static_cast<std::size_t>(unit)].word;
}

double FactorOf(Quantity quantity, const SurveyHead& head) {
  switch (quantity) {
    case Q::kLength:
      return FactorOf(head.md_unit);
    case Q::kGridLength:
      return FactorOf(head.grid_unit);
    case Q::kAngle:
    case Q::kDirection:
      return units::kDeg;
    case Q::kCurvature:
      return FactorOf(head.curvature_unit);
    case Q::kArea:
      return FactorOf(head.md_unit) * FactorOf(head.md_unit);
    case Q::kRate:
      return units::kDegPerHour;
    default:
      return 1;
  }
}

std::string UnitOf(Quantity quantity, const SurveyHead& head) {
  switch (quantity) {
    case Q::kLength:
      return std::string(WordOf(head.md_unit));
    case Q::kGridLength:
      return std::string(WordOf(head.grid_unit));
    case Q::kAngle:
    case Q::kDirection:
      return "deg";
    case Q::kCurvature:
      return std::string(WordOf(head.curvature_unit));
    case Q::kArea:
      return std::string(WordOf(head.md_unit)) + "2";
    case Q::kAcceleration:
      return "m/s2";
    case Q::kRate:
      return "deg/h";
    case Q::kTemperature:
      return "degC";
    case Q::kTime:
      return "s";
    default:
      return "";
  }
}

std::string Exact(double value, double factor) {
  if (value == 0) return "0";
  const double quotient = value / factor;
  char text[40];
  for (const double q :
       {quotient, std::nextafter(quotient, INFINITY), std::nextafter(quotient, -INFINITY)}) {
    for (const int digits : {15, 16, 17}) {
      const auto end =
          std::to_chars(text, text + sizeof text, q, std::chars_format::general, digits);
      const std::string_view written(text, static_cast<std::size_t>(end.ptr - text));
      const std::optional<double> back = NumberOf(written);
      if (back && *back * factor == value) return std::string(written);
    }
  }
  // The quotient's grid is coarser than the value's here: one rounding is lost.
  return fmt::format("{:.17g}", quotient);
}

std::string Exact(Quantity quantity, double value, const SurveyHead& head) {
  const std::string text = Exact(value, FactorOf(quantity, head));
  return quantity == Quantity::kDirection && text == "360" ? "0" : text;
}

double ValueOf(Quantity quantity, double number, double factor) {
  if (quantity != Quantity::kDirection) return number * factor;
  if (number >= 0 && number < kTwoPi / factor) {
    const double value = number * factor;
    return value < kTwoPi ? value : 0;
  }
  return WrapTwoPi(number * factor);
}

}  // namespace wellgyro
