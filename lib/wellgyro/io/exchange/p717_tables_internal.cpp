#include <algorithm>
#include <cstddef>

#include "wellgyro/io/exchange/p717_internal.h"
#include "wellgyro/io/iso_time_internal.h"

namespace wellgyro::p717 {
namespace {

struct Unit {
  std::string_view name;
  int number_2019, number_2018;
};
constexpr std::array kUnits{
    Unit{"m", 1, 1},           Unit{"rad", 2, 2},     Unit{"deg", 3, 3},
    Unit{"-", 4, 4},           Unit{"ft", 11, 5},     Unit{"ftUS", 12, 6},
    Unit{"m/s2", 26, 20},      Unit{"rad/m", 27, 21}, Unit{"deg/30m", 28, 22},
    Unit{"deg/100ft", 29, 23}, Unit{"deg/h", 33, 27}, Unit{"m2", 34, 28},
    Unit{"ft2", 35, 29},       Unit{"ftUS2", 36, 30}, Unit{"s", 18, 15},
};

constexpr std::array kTypes{
    ObjectType{1, "SRP", "Structure Reference Point"},
    ObjectType{2, "WRP", "Well Reference Point"},
    ObjectType{3, "ZDP", "Zero-depth Point"},
    ObjectType{4, "PC", "Platform Centre"},
    ObjectType{5, "DFC", "Drill Floor Centre"},
    ObjectType{6, "GL", "Ground Level"},
    ObjectType{7, "SF", "Sea Floor"},
    ObjectType{8, "D", "Surveyed Data Point"},
    ObjectType{9, "CP", "Casing Point"},
    ObjectType{10, "TP", "Tie-in Point"},
    ObjectType{11, "KOP", "Kick Off Point"},
    ObjectType{12, "FT", "Formation Top"},
    ObjectType{13, "PP", "Reservoir Penetration Point"},
    ObjectType{14, "PERF", "Perforation Point"},
    ObjectType{15, "BHL", "Bottom Hole Location"},
};

constexpr std::array<std::string_view, 10> kStatuses{"Surveyed",
                                                     "Surveyed",
                                                     "Planned",
                                                     "INC Interpolated",
                                                     "AZ Interpolated",
                                                     "INC and AZ Interpolated",
                                                     "Projected",
                                                     "Trended",
                                                     "INC and AZ back-calculated",
                                                     "Other"};

}  // namespace

std::string_view UnitName(int number, bool draft_2018) {
  for (const Unit& unit : kUnits) {
    if ((draft_2018 ? unit.number_2018 : unit.number_2019) == number) return unit.name;
  }
  return {};
}

int UnitNumber(std::string_view name) {
  for (const Unit& unit : kUnits) {
    if (unit.name == name) return unit.number_2019;
  }
  return 4;
}

const ObjectType* TypeOfCode(std::string_view code) {
  const auto* found = std::find_if(kTypes.begin(), kTypes.end(),
                                   [&](const ObjectType& t) { return t.code == code; });
  return found == kTypes.end() ? nullptr : found;
}

const ObjectType* TypeOfNumber(int number) {
  return number >= 1 && number <= static_cast<int>(kTypes.size())
             ? &kTypes[static_cast<std::size_t>(number - 1)]
             : nullptr;
}

std::string_view StatusText(int number) { return kStatuses[static_cast<std::size_t>(number)]; }

int NumberOfStatus(RowStatus status) {
  return status == RowStatus::kTieIn ? 9 : static_cast<int>(status);
}

RowStatus StatusOf(int number, std::string_view point) {
  if (number == 9 && point == "TP") return RowStatus::kTieIn;
  return number >= 0 && number <= 9 ? static_cast<RowStatus>(number) : RowStatus::kOther;
}

const std::vector<Extension>& Extensions() {
  using C = Column;
  static const std::vector<Extension> kAll{
      {4, "var_N", C::kVarNN},
      {5, "var_E", C::kVarEE},
      {6, "var_D", C::kVarVV},
      {7, "cov_NE", C::kCovNE},
      {8, "cov_ND", C::kCovNV},
      {9, "cov_ED", C::kCovEV},
      {16, "AZ_MAGN", C::kAzimuthMagnetic},
      {17, "AZ_TRUE", C::kAzimuthTrue},
      {18, "AZ_GRID", C::kAzimuthGrid},
      {19, "Conv.", C::kConvergence},
      {20, "sf", C::kScale},
      {27, "dogleg", C::kDogleg},
      {28, "build rate", C::kBuild},
      {29, "turn rate", C::kTurn},
      {33, "closure dist", C::kClosure},
      {34, "vert section", C::kVerticalSection},
      {35, "comment", {}, TextColumn::kComment},
      {36, "UTC", C::kUtc},
      {100, "GTF", C::kToolface, {}, "deg"},
      {101, "MTF", C::kMagneticToolface, {}, "deg"},
      {102, "closure az", C::kClosureAzimuth, {}, "deg"},
      {103, "bias_N", C::kBiasN},
      {104, "bias_E", C::kBiasE},
      {105, "bias_D", C::kBiasV},
      {106, "sig_INC", C::kSigmaInclination, {}, "deg"},
      {107, "sig_AZ", C::kSigmaAzimuth, {}, "deg"},
      {108, "Gtot", C::kGravity, {}, "m/s2"},
      {109, "refG", C::kGravityRef, {}, "m/s2"},
      {110, "TotalER", C::kEarthRateMeasured, {}, "deg/h"},
      {111, "refER", C::kEarthRateReference, {}, "deg/h"},
      {112, "temperature", C::kTemperature, {}, "-"},
      {113, "TVDSS", C::kTvdSubSea},
      {120, "kind", {}, TextColumn::kKind},
      {121, "quality", {}, TextColumn::kQuality},
      {122, "uid", {}, TextColumn::kUid},
      {123, "tool", {}, TextColumn::kTool},
  };
  return kAll;
}

std::string TimeText(double utc) {
  std::string text = IsoUtc(utc);
  text.pop_back();
  for (char& c : text) c = c == '-' || c == 'T' ? ':' : c;
  return text;
}

std::optional<double> TimeOf(std::string_view text) {
  if (text.size() < 19) return std::nullopt;
  std::string iso(text);
  iso[4] = iso[7] = '-';
  iso[10] = 'T';
  return UtcOf(iso + "Z");
}

std::string ColonDate(std::string_view iso) {
  std::string text(iso.substr(0, iso.find('T')));
  if (text.size() == 10 && text[4] == '-' && text[7] == '-') text[4] = text[7] = ':';
  return text;
}

std::string IsoDate(std::string_view colons) {
  std::string text(colons);
  if (text.size() == 10 && text[4] == ':' && text[7] == ':') text[4] = text[7] = '-';
  return text;
}

}  // namespace wellgyro::p717
