#include "wellgyro/io/sensor/sensor_layout_internal.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "wellgyro/base/alike.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro::sensors {
namespace {

enum Quantity : std::uint8_t { kClock, kRate, kForce, kField, kLength, kTension, kSeconds, kPlain };

struct Unit {
  Quantity quantity;
  std::string_view name;
  double factor;
};
constexpr std::array kUnits{
    Unit{kClock, "ns", 1},
    Unit{kClock, "us", 1e3},
    Unit{kClock, "ms", 1e6},
    Unit{kClock, "s", 1e9},
    Unit{kRate, "rad/s", 1},
    Unit{kRate, "deg/s", units::kDeg},
    Unit{kRate, "deg/h", units::kDegPerHour},
    Unit{kForce, "m/s2", 1},
    Unit{kForce, "g", units::kStandardGravity},
    Unit{kForce, "mg", units::kMilliG},
    Unit{kField, "T", 1},
    Unit{kField, "nT", units::kNanotesla},
    Unit{kLength, "m", 1},
    Unit{kLength, "ft", units::kFoot},
    Unit{kTension, "N", 1},
    Unit{kTension, "kN", 1e3},
    Unit{kTension, "lbf", 4.4482216152605},
    Unit{kSeconds, "s", 1},
    Unit{kPlain, "", 1},
    Unit{kPlain, "degC", 1},
};

struct Name {
  std::string_view name;
  Quantity quantity;
};
constexpr std::array<Name, kColumns> kNames{{
    {"UTC", kClock},     {"END_UTC", kClock},     {"TOOL", kClock},      {"GX", kRate},
    {"GY", kRate},       {"GZ", kRate},           {"AX", kForce},        {"AY", kForce},
    {"AZ", kForce},      {"MX", kField},          {"MY", kField},        {"MZ", kField},
    {"SIG_GX", kRate},   {"SIG_GY", kRate},       {"SIG_GZ", kRate},     {"SIG_AX", kForce},
    {"SIG_AY", kForce},  {"SIG_AZ", kForce},      {"TEMP", kPlain},      {"DURATION", kSeconds},
    {"MD", kLength},     {"LENGTH", kLength},     {"SIG_MD", kLength},   {"TENSION", kTension},
    {"STOPPED", kPlain}, {"MARK", kPlain},        {"CORRECTED", kPlain}, {"INDEX", kPlain},
    {"RUN", kPlain},     {"TOOL_NUMBER", kPlain},
}};

/// As much of what a file says as a complaint may show.
std::string Shown(std::string_view text) {
  std::string shown(text.substr(0, 40));
  std::ranges::replace_if(
      shown, [](char c) { return c < 0x20 || c > 0x7e; }, '?');
  return shown;
}

/// What others call a column; letters of a name alone would not tell.
constexpr std::array<std::array<std::string_view, 2>, 12> kOthersNames{{
    {"depth", "MD"},
    {"dept", "MD"},
    {"time", "UTC"},
    {"fx", "AX"},
    {"fy", "AY"},
    {"fz", "AZ"},
    {"wx", "GX"},
    {"wy", "GY"},
    {"wz", "GZ"},
    {"bx", "MX"},
    {"by", "MY"},
    {"bz", "MZ"},
}};

/// Whether `unit` measures what a column holds; one that is none tells nothing, and may.
bool MayHold(const Name& column, std::string_view unit) {
  const auto is_unit = [unit](const Unit& known) { return known.name == unit; };
  return unit.empty() || std::ranges::none_of(kUnits, is_unit) ||
         std::ranges::any_of(kUnits, [&](const Unit& known) {
           return is_unit(known) && known.quantity == column.quantity;
         });
}

/// The column that seems to be meant by a heading's name and unit; empty: none.
std::string Meant(std::string_view name, std::string_view unit) {
  const std::string lower = Lower(Shown(name));
  const auto is_meant = [&lower](const auto& others) { return others[0] == lower; };
  if (const auto found = std::ranges::find_if(kOthersNames, is_meant);
      found != kOthersNames.end()) {
    return std::string((*found)[1]);
  }
  std::vector<std::string> names, lowers;
  for (const Name& one : kNames) {
    if (MayHold(one, unit)) lowers.push_back(Lower(names.emplace_back(one.name)));
  }
  const std::string like = Nearest(lower, lowers);
  const auto place = std::ranges::find(lowers, like) - lowers.begin();
  return like.empty() ? like : names[static_cast<std::size_t>(place)];
}

/// What is said of a heading whose name is none of a sensor's.
std::string UnknownColumn(std::string_view heading, std::string_view name, std::string_view unit) {
  std::vector<std::string_view> known;
  for (const Name& one : kNames) known.push_back(one.name);
  const std::string meant = Meant(name, unit);
  return fmt::format("column \"{}\" is not known; {} are {}", Shown(heading),
                     meant.empty() ? "known" : fmt::format("is {} meant? Known", meant),
                     fmt::join(known, ", "));
}

/// What is said of a column in a unit that does not measure it.
std::string UnknownUnit(const Name& column, std::string_view unit) {
  if (column.quantity == kPlain) {
    return fmt::format("column {} takes {}no unit, not [{}]", column.name,
                       column.name == "TEMP" ? "degC or " : "", Shown(unit));
  }
  std::vector<std::string> known;
  for (const Unit& one : kUnits) {
    if (one.quantity == column.quantity) known.emplace_back(one.name);
  }
  // Of one letter each is like no unit at all.
  const std::string meant = unit.empty() ? "" : Nearest(Shown(unit), known);
  const auto near = std::ranges::find(known, meant);
  if (near != known.end()) std::rotate(known.begin(), near, near + 1);
  return fmt::format("column {} has no unit that is known: [{}]; known are {}", column.name,
                     Shown(unit), fmt::join(known, ", "));
}

}  // namespace

std::optional<HeadedUnit> HeadedUnitOf(std::string_view heading) {
  const std::size_t bracket = heading.find('[');
  HeadedUnit found{Trim(heading.substr(0, bracket)), {}};
  if (bracket == std::string_view::npos) return found;
  if (!heading.ends_with(']')) return std::nullopt;
  found.unit = heading.substr(bracket + 1, heading.size() - bracket - 2);
  const auto name =
      std::ranges::find_if(kNames, [&](const Name& known) { return known.name == found.name; });
  for (const Unit& unit : kUnits) {
    // Seconds are those of a clock, but in DURATION.
    if (unit.name != found.unit || (name != kNames.end() && unit.quantity != name->quantity)) {
      continue;
    }
    found.clock = unit.quantity == kClock;
    found.rate = unit.quantity == kRate;
    found.force = unit.quantity == kForce;
    found.factor = unit.factor;
    return found;
  }
  return std::nullopt;
}

void Layout::Take(std::string_view heading, int field) {
  const std::size_t bracket = heading.find('[');
  const std::string_view name = Trim(heading.substr(0, bracket));
  std::string_view unit;
  if (bracket != std::string_view::npos && heading.ends_with(']')) {
    unit = heading.substr(bracket + 1, heading.size() - bracket - 2);
  }
  const auto complain = [&](const auto& text) {
    if (!complaint.empty()) return;
    complaint = text();
    complaint_field = field;
  };
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i].name != name) continue;
    meant = true;
    if (places[i].field >= 0) {
      return complain([&] { return fmt::format("column {} stands twice", name); });
    }
    const auto known = std::ranges::find_if(
        kUnits, [&](const Unit& u) { return u.quantity == kNames[i].quantity && u.name == unit; });
    if (known == kUnits.end()) return complain([&] { return UnknownUnit(kNames[i], unit); });
    places[i] = {field, known->factor};
    return;
  }
  complain([&] { return UnknownColumn(heading, name, unit); });
}

std::optional<SensorTable> Layout::Kind() const {
  const bool sensors = HasAll({kGx, kGy, kAx, kAy, kAz});
  if (sensors && Has(kDuration) && Has(kUtc)) return SensorTable::kStill;
  if (sensors && !Has(kDuration) && (Has(kUtc) || Has(kTool))) return SensorTable::kSamples;
  const bool timed = Has(kUtc) || (Has(kTool) && !Has(kEndUtc));
  if (!sensors && timed && (Has(kMd) || Has(kLengthOf))) return SensorTable::kDepth;
  return std::nullopt;
}

std::string Layout::Lacking() const {
  const std::array sensors{kGx, kGy, kAx, kAy, kAz};
  const bool any = std::ranges::any_of(sensors, [this](SensorColumn c) { return Has(c); });
  std::string missing;
  const auto need = [&missing](bool has, std::string_view name) {
    if (!has) missing += fmt::format("{}{}", missing.empty() ? "" : ", ", name);
  };
  if (!any) {
    if (Has(kEndUtc)) {
      need(Has(kUtc), "UTC");
    } else {
      need(Has(kUtc) || Has(kTool), "UTC or TOOL");
    }
    need(Has(kMd) || Has(kLengthOf), "MD or LENGTH");
    return fmt::format("a table of depths lacks {}", missing);
  }
  for (const SensorColumn c : sensors) need(Has(c), kNames[c].name);
  if (Has(kDuration)) {
    need(Has(kUtc), "UTC");
  } else {
    need(Has(kUtc) || Has(kTool), "UTC or TOOL");
  }
  return fmt::format("a table of {} lacks {}", Has(kDuration) ? "averages" : "samples", missing);
}

Layout LayoutOf(std::string_view header) {
  if (header.starts_with("\xEF\xBB\xBF")) header.remove_prefix(3);
  std::vector<std::string_view> fields;
  SplitCells(header, ',', fields);
  Layout layout;
  for (std::size_t i = 0; i < fields.size(); ++i) layout.Take(fields[i], static_cast<int>(i));
  return layout;
}

}  // namespace wellgyro::sensors
