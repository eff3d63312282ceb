#include "wellgyro/io/columns_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/line_reader_internal.h"

namespace wellgyro {
namespace {

using C = Column;
using Q = Quantity;

constexpr std::array<ColumnInfo, kColumns> kInfo{{
    {C::kMd, Q::kLength, "MD", "DEPT", "measured depth"},
    {C::kInclination, Q::kAngle, "INC", "DEVI", "inclination from vertical"},
    {C::kAzimuth, Q::kDirection, "AZI", "AZIM", "azimuth of the hole"},
    {C::kTvd, Q::kLength, "TVD", "TVD", "true vertical depth"},
    {C::kNorth, Q::kLength, "N", "NSDR", "north offset from the well head"},
    {C::kEast, Q::kLength, "E", "EWDR", "east offset from the well head"},
    {C::kNorthing, Q::kGridLength, "NORTHING", "NORTHING", "northing"},
    {C::kEasting, Q::kGridLength, "EASTING", "EASTING", "easting"},
    {C::kDown, Q::kGridLength, "DOWN", "DOWN", "depth below the vertical reference"},
    {C::kLatitude, Q::kAngle, "LAT", "LATI", "latitude"},
    {C::kLongitude, Q::kAngle, "LON", "LONG", "longitude"},
    {C::kTvdSubSea, Q::kLength, "TVDSS", "TVDSS", "true vertical depth below mean sea level"},
    {C::kDogleg, Q::kCurvature, "DLS", "DLS", "dogleg severity"},
    {C::kBuild, Q::kCurvature, "BUILD", "BUILD", "build rate"},
    {C::kTurn, Q::kCurvature, "TURN", "TURN", "turn rate"},
    {C::kToolface, Q::kDirection, "GTF", "GTF", "gravity toolface"},
    {C::kMagneticToolface, Q::kDirection, "MTF", "MTF", "magnetic toolface"},
    {C::kVerticalSection, Q::kLength, "VS", "VSEC", "vertical section"},
    {C::kClosure, Q::kLength, "CLOSURE", "CLSR", "closure distance"},
    {C::kClosureAzimuth, Q::kDirection, "CLOSURE_AZI", "CLSRA", "closure azimuth"},
    {C::kAzimuthTrue, Q::kDirection, "AZI_TRUE", "AZT", "azimuth from true north"},
    {C::kAzimuthGrid, Q::kDirection, "AZI_GRID", "AZG", "azimuth from grid north"},
    {C::kAzimuthMagnetic, Q::kDirection, "AZI_MAG", "AZM", "azimuth from magnetic north"},
    {C::kVarNN, Q::kArea, "VAR_NN", "VARNN", "variance of north"},
    {C::kCovNE, Q::kArea, "COV_NE", "COVNE", "covariance of north and east"},
    {C::kCovNV, Q::kArea, "COV_NV", "COVNV", "covariance of north and vertical"},
    {C::kVarEE, Q::kArea, "VAR_EE", "VAREE", "variance of east"},
    {C::kCovEV, Q::kArea, "COV_EV", "COVEV", "covariance of east and vertical"},
    {C::kVarVV, Q::kArea, "VAR_VV", "VARVV", "variance of vertical"},
    {C::kBiasN, Q::kLength, "BIAS_N", "BIASN", "bias of north"},
    {C::kBiasE, Q::kLength, "BIAS_E", "BIASE", "bias of east"},
    {C::kBiasV, Q::kLength, "BIAS_V", "BIASV", "bias of vertical"},
    {C::kSigmaInclination, Q::kAngle, "SIG_INC", "SIGINC", "sigma of inclination"},
    {C::kSigmaAzimuth, Q::kAngle, "SIG_AZI", "SIGAZI", "sigma of azimuth"},
    {C::kGravity, Q::kAcceleration, "GRAVITY", "GTOT", "measured gravity"},
    {C::kGravityRef, Q::kAcceleration, "GRAVITY_REF", "GREF", "reference gravity"},
    {C::kEarthRateMeasured, Q::kRate, "EARTH_RATE", "ERATE", "measured Earth rate"},
    {C::kEarthRateReference, Q::kRate, "EARTH_RATE_REF", "ERREF", "reference Earth rate"},
    {C::kConvergence, Q::kAngle, "CONV", "CONV", "grid convergence"},
    {C::kScale, Q::kRatio, "SCALE", "SCALE", "grid scale factor"},
    {C::kTemperature, Q::kTemperature, "TEMP", "TEMP", "temperature"},
    {C::kUtc, Q::kTime, "UTC", "UTC", "UTC since 1970"},
    {C::kSurvey, Q::kNumber, "SURVEY", "SURVEY", "number of the survey"},
    {C::kObject, Q::kNumber, "OBJECT", "OBJECT", "number of the position object"},
}};

constexpr std::array kTextInfo{
    TextColumnInfo{TextColumn::kUid, "UID"},
    TextColumnInfo{TextColumn::kPoint, "POINT"},
    TextColumnInfo{TextColumn::kTool, "TOOL"},
    TextColumnInfo{TextColumn::kErrorModel, "ERROR_MODEL"},
    TextColumnInfo{TextColumn::kKind, "KIND"},
    TextColumnInfo{TextColumn::kQuality, "QUALITY"},
    TextColumnInfo{TextColumn::kComment, "COMMENT"},
};

struct Alias {
  std::string_view name;  // letters and digits alone, in lower case
  Column column;
  North north = North::kUnknown;
};

constexpr std::array kAliases{
    Alias{"measureddepth", C::kMd},
    Alias{"measdepth", C::kMd},
    Alias{"mdepth", C::kMd},
    Alias{"depth", C::kMd},
    Alias{"dept", C::kMd},
    Alias{"incl", C::kInclination},
    Alias{"inclination", C::kInclination},
    Alias{"devi", C::kInclination},
    Alias{"sdev", C::kInclination},
    Alias{"deviation", C::kInclination},
    Alias{"azi", C::kAzimuth},
    Alias{"azim", C::kAzimuth},
    Alias{"azimuth", C::kAzimuth},
    Alias{"haz", C::kAzimuth},
    Alias{"hazi", C::kAzimuth},
    Alias{"holeazimuth", C::kAzimuth},
    Alias{"azitrue", C::kAzimuth, North::kTrue},
    Alias{"aztrue", C::kAzimuth, North::kTrue},
    Alias{"azimtrue", C::kAzimuth, North::kTrue},
    Alias{"azimuthtrue", C::kAzimuth, North::kTrue},
    Alias{"azimuthtruenorth", C::kAzimuth, North::kTrue},
    Alias{"azimtn", C::kAzimuth, North::kTrue},
    Alias{"azt", C::kAzimuth, North::kTrue},
    Alias{"azigrid", C::kAzimuth, North::kGrid},
    Alias{"azgrid", C::kAzimuth, North::kGrid},
    Alias{"azimgrid", C::kAzimuth, North::kGrid},
    Alias{"azimuthgrid", C::kAzimuth, North::kGrid},
    Alias{"azimuthgridnorth", C::kAzimuth, North::kGrid},
    Alias{"azimgn", C::kAzimuth, North::kGrid},
    Alias{"azg", C::kAzimuth, North::kGrid},
    Alias{"azimag", C::kAzimuth, North::kMagnetic},
    Alias{"azimagn", C::kAzimuth, North::kMagnetic},
    Alias{"azmag", C::kAzimuth, North::kMagnetic},
    Alias{"azmagn", C::kAzimuth, North::kMagnetic},
    Alias{"azimuthmagnetic", C::kAzimuth, North::kMagnetic},
    Alias{"azm", C::kAzimuth, North::kMagnetic},
    Alias{"trueverticaldepth", C::kTvd},
    Alias{"tvdzdp", C::kTvd},
    Alias{"north", C::kNorth},
    Alias{"ns", C::kNorth},
    Alias{"nsdr", C::kNorth},
    Alias{"dispns", C::kNorth},
    Alias{"nsoffset", C::kNorth},
    Alias{"northoffset", C::kNorth},
    Alias{"ntrue", C::kNorth, North::kTrue},
    Alias{"ngrid", C::kNorth, North::kGrid},
    Alias{"east", C::kEast},
    Alias{"ew", C::kEast},
    Alias{"ewdr", C::kEast},
    Alias{"dispew", C::kEast},
    Alias{"ewoffset", C::kEast},
    Alias{"eastoffset", C::kEast},
    Alias{"etrue", C::kEast, North::kTrue},
    Alias{"egrid", C::kEast, North::kGrid},
    Alias{"latitude", C::kLatitude},
    Alias{"lati", C::kLatitude},
    Alias{"longitude", C::kLongitude},
    Alias{"long", C::kLongitude},
    Alias{"dogleg", C::kDogleg},
    Alias{"dleg", C::kDogleg},
    Alias{"doglegseverity", C::kDogleg},
    Alias{"buildrate", C::kBuild},
    Alias{"turnrate", C::kTurn},
    Alias{"toolface", C::kToolface},
    Alias{"vsec", C::kVerticalSection},
    Alias{"vertsect", C::kVerticalSection},
    Alias{"verticalsection", C::kVerticalSection},
    Alias{"clsr", C::kClosure},
    Alias{"closuredistance", C::kClosure},
    Alias{"closureazimuth", C::kClosureAzimuth},
    Alias{"temperature", C::kTemperature},
};

constexpr std::array<std::pair<RowStatus, std::string_view>, 11> kStatusWords{{
    {RowStatus::kUnused, "unused"},
    {RowStatus::kSurveyed, "surveyed"},
    {RowStatus::kPlanned, "planned"},
    {RowStatus::kInclinationInterpolated, "inclination_interpolated"},
    {RowStatus::kAzimuthInterpolated, "azimuth_interpolated"},
    {RowStatus::kInterpolated, "interpolated"},
    {RowStatus::kProjected, "projected"},
    {RowStatus::kTrended, "trended"},
    {RowStatus::kBackCalculated, "back_calculated"},
    {RowStatus::kOther, "other"},
    {RowStatus::kTieIn, "tie_in"},
}};

constexpr std::array<std::pair<SurveyTool, std::string_view>, 7> kToolWords{{
    {SurveyTool::kGyroContinuous, "gyroscopic inertial"},
    {SurveyTool::kGyroNorthSeeking, "gyroscopic north seeking"},
    {SurveyTool::kGyroMwd, "gyroscopic MWD"},
    {SurveyTool::kMagneticMwd, "magnetic MWD"},
    {SurveyTool::kMagneticMultishot, "magnetic multiple-shot"},
    {SurveyTool::kMagneticSingleShot, "magnetic single-shot"},
    {SurveyTool::kInclinationOnly, "inclination only"},
}};

std::string LettersAndDigits(std::string_view text) {
  std::string kept;
  for (const char c : Lower(text)) {
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) kept += c;
  }
  return kept;
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

// Finds what `name` is a heading of, if of anything.
void NameHeading(Heading& found, std::string_view name) {
  const std::string plain = LettersAndDigits(name);
  found.status = plain == "status";
  for (const TextColumnInfo& info : kTextInfo) {
    if (plain == LettersAndDigits(info.csv)) found.text = info.column;
  }
  for (const Alias& alias : kAliases) {
    if (plain != alias.name) continue;
    found.column = alias.column;
    found.north = alias.north;
    return;
  }
  for (const ColumnInfo& info : kInfo) {
    if (plain == LettersAndDigits(info.csv)) found.column = info.column;
  }
}

}  // namespace

std::span<const ColumnInfo> AllColumns() { return kInfo; }
const ColumnInfo& InfoOf(Column column) { return kInfo[static_cast<std::size_t>(column)]; }
std::span<const TextColumnInfo> AllTextColumns() { return kTextInfo; }

Heading HeadingOf(std::string_view heading) {
  Heading found;
  heading = Trim(heading);
  const std::size_t bracket = heading.find_first_of("[(");
  const std::string_view name = heading.substr(0, bracket);
  if (bracket != std::string_view::npos) {
    const std::size_t close = heading.find_last_of("])");
    const std::size_t end = close == std::string_view::npos ? heading.size() : close;
    if (end > bracket) found.unit = Trim(heading.substr(bracket + 1, end - bracket - 1));
    NameHeading(found, name);
    return found;
  }
  NameHeading(found, name);
  for (const std::string_view unit : {"m", "ft", "deg"}) {  // as md_ft
    const std::size_t line = name.find_last_of('_');
    if (found.column || line == std::string_view::npos) break;
    if (!EqualNoCase(name.substr(line + 1), unit)) continue;
    found.unit = unit;
    NameHeading(found, name.substr(0, line));
  }
  return found;
}

std::optional<LengthUnit> LengthUnitOf(std::string_view unit) {
  const std::string plain = WithoutBlanks(unit);
  for (const std::string_view m : {"m", "metre", "metres", "meter", "meters", "mtr"}) {
    if (plain == m) return LengthUnit::kMetre;
  }
  for (const std::string_view ft : {"ft", "f", "foot", "feet"}) {
    if (plain == ft) return LengthUnit::kFoot;
  }
  for (const std::string_view us : {"ftus", "usft", "ft[us]", "ussurveyfoot", "ussurveyfeet"}) {
    if (plain == us) return LengthUnit::kUsFoot;
  }
  return std::nullopt;
}

std::optional<double> FactorOf(Quantity quantity, std::string_view unit) {
  const std::string plain = WithoutBlanks(unit);
  const auto is = [&](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), plain) != names.end();
  };
  switch (quantity) {
    case Q::kLength:
    case Q::kGridLength:
      if (const auto length = LengthUnitOf(plain)) return FactorOf(*length);
      if (is({"cm"})) return 0.01;
      if (is({"mm"})) return 0.001;
      if (is({"km"})) return 1000;
      if (is({"in"})) return 0.0254;
      return std::nullopt;
    case Q::kAngle:
    case Q::kDirection:
      if (is({"deg", "dega", "degree", "degrees", "dg", "\xC2\xB0"})) return units::kDeg;
      if (is({"rad", "radians"})) return 1;
      if (is({"gon", "grad"})) return kPi / 200;
      return std::nullopt;
    case Q::kCurvature:
      return CurvatureFactor(plain);
    case Q::kArea: {
      if (!plain.ends_with('2')) return std::nullopt;
      const auto length = LengthUnitOf(std::string_view(plain).substr(0, plain.size() - 1));
      if (!length) return std::nullopt;
      return FactorOf(*length) * FactorOf(*length);
    }
    case Q::kAcceleration:
      if (is({"m/s2"})) return 1;
      if (is({"ft/s2"})) return units::kFoot;
      if (is({"g", "gn"})) return units::kStandardGravity;
      if (is({"mg", "mgn"})) return units::kMilliG;
      return std::nullopt;
    case Q::kRate:
      if (is({"deg/h", "deg/hr", "dega/h"})) return units::kDegPerHour;
      if (is({"deg/s", "dega/s"})) return units::kDeg;
      if (is({"rad/s"})) return 1;
      return std::nullopt;
    case Q::kTemperature:
      if (is({"degc", "c",
              "\xC2\xB0"
              "c"})) {
        return 1;
      }
      return std::nullopt;
    case Q::kTime:
      if (is({"s", "sec"})) return 1;
      return std::nullopt;
    case Q::kRatio:
    case Q::kNumber:
      return plain.empty() || plain == "1" || plain == "-" ? std::optional<double>(1)
                                                           : std::nullopt;
  }
  return std::nullopt;
}

std::optional<CurvatureUnit> CurvatureUnitOf(std::string_view unit) {
  const std::optional<double> factor = FactorOf(Quantity::kCurvature, unit);
  if (!factor) return std::nullopt;
  for (const CurvatureUnit known :
       {CurvatureUnit::kDegPer30m, CurvatureUnit::kDegPer100ft, CurvatureUnit::kDegPerMetre,
        CurvatureUnit::kDegPerFoot, CurvatureUnit::kRadPerMetre}) {
    if (std::abs(*factor / FactorOf(known) - 1) < 1e-12) return known;
  }
  return std::nullopt;
}

double FactorOf(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::kFoot:
      return units::kFoot;
    case LengthUnit::kUsFoot:
      return units::kUsSurveyFoot;
    default:
      return 1;
  }
}

double FactorOf(CurvatureUnit unit) {
  switch (unit) {
    case CurvatureUnit::kDegPer100ft:
      return units::kDegPer100ft;
    case CurvatureUnit::kDegPerMetre:
      return units::kDeg;
    case CurvatureUnit::kDegPerFoot:
      return units::kDeg / units::kFoot;
    case CurvatureUnit::kRadPerMetre:
      return 1;
    default:
      return units::kDegPer30m;
  }
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
      switch (head.curvature_unit) {
        case CurvatureUnit::kDegPer100ft:
          return "deg/100ft";
        case CurvatureUnit::kDegPerMetre:
          return "deg/m";
        case CurvatureUnit::kDegPerFoot:
          return "deg/ft";
        case CurvatureUnit::kRadPerMetre:
          return "rad/m";
        default:
          return "deg/30m";
      }
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

std::string_view WordOf(LengthUnit unit) {
  return unit == LengthUnit::kMetre ? "m" : unit == LengthUnit::kFoot ? "ft" : "ftUS";
}

std::string_view WordOf(North north) {
  switch (north) {
    case North::kTrue:
      return "true";
    case North::kGrid:
      return "grid";
    case North::kMagnetic:
      return "magnetic";
    default:
      return "unknown";
  }
}

std::optional<North> NorthOf(std::string_view word) {
  const std::string plain = LettersAndDigits(word);
  if (plain == "true" || plain == "truenorth") return North::kTrue;
  if (plain == "grid" || plain == "gridnorth") return North::kGrid;
  if (plain == "magnetic" || plain == "magneticnorth") return North::kMagnetic;
  return std::nullopt;
}

std::string_view WordOf(RowStatus status) {
  return kStatusWords[static_cast<std::size_t>(status)].second;
}

std::optional<RowStatus> RowStatusOf(std::string_view word) {
  for (const auto& [status, name] : kStatusWords) {
    if (name == word) return status;
  }
  return std::nullopt;
}

std::string_view WordOf(SurveyTool tool) {
  for (const auto& [known, word] : kToolWords) {
    if (known == tool) return word;
  }
  return {};
}

std::optional<SurveyTool> SurveyToolOf(std::string_view word) {
  // WITSML 1.4's list of values writes one of them with two blanks.
  std::string single;
  for (const char c : word) {
    if (c != ' ' || !single.ends_with(' ')) single += c;
  }
  for (const auto& [tool, known] : kToolWords) {
    if (EqualNoCase(single, known)) return tool;
  }
  return std::nullopt;
}

std::string Exact(double value, double factor) {
  if (value == 0) return "0";
  const double quotient = value / factor;
  for (const double q :
       {quotient, std::nextafter(quotient, INFINITY), std::nextafter(quotient, -INFINITY)}) {
    for (const int digits : {15, 16, 17}) {
      std::string text = fmt::format("{:.{}g}", q, digits);
      const std::optional<double> back = NumberOf(text);
      if (back && *back * factor == value) return text;
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
