// "WELL TRACE FROM PETREL", as Petrel exports and many open readers take it.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/certificate_internal.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

constexpr std::string_view kRule =
    "#====================================================================================\n";

// After the colon of "# WELL NAME:   A-1".
std::string_view AfterColon(std::string_view line) {
  const std::size_t colon = line.rfind(": ");
  return colon == std::string_view::npos ? std::string_view() : Trim(line.substr(colon + 1));
}

// Number and unit of "25.0 (m)"; the unit may be missing.
struct Length {
  double number = 0;
  std::optional<LengthUnit> unit;
};
std::optional<Length> LengthOf(std::string_view text) {
  const std::size_t open = text.find('(');
  const auto number = NumberOf(text.substr(0, open));
  if (!number) return std::nullopt;
  if (open == std::string_view::npos) return Length{*number, std::nullopt};
  return Length{*number, LengthUnitOf(text.substr(open + 1, text.find(')') - open - 1))};
}

constexpr std::array kPetrelNames{NamedColumn{"MD", Column::kMd},
                                  NamedColumn{"X", Column::kEasting},
                                  NamedColumn{"Y", Column::kNorthing},
                                  NamedColumn{"TVD", Column::kTvd},
                                  NamedColumn{"DX", Column::kEast},
                                  NamedColumn{"DY", Column::kNorth},
                                  NamedColumn{"INCL", Column::kInclination},
                                  NamedColumn{"DLS", Column::kDogleg},
                                  NamedColumn{"Z", Column::kDown},
                                  NamedColumn{"AZIM_TN", Column::kAzimuthTrue},
                                  NamedColumn{"AZIM_GN", Column::kAzimuthGrid}};

// Depths stand in the unit of the line DEPTH, coordinates in that of the line DX DY; MD with the
// depths. A head without those lines leaves the units open.
class PetrelReader {
 public:
  PetrelReader(LineReader& lines, const ReadOptions& options, Claims& claims)
      : lines_(lines), options_(options), claims_(claims) {}

  SurveyTable Read() {
    std::string_view line;
    while (lines_.Next(line)) {
      const std::string_view text = Trim(line);
      if (text.empty()) continue;
      if (text.front() == '#') {
        Header(text);
      } else if (names_.empty()) {
        Columns(text);
      } else {
        Row(text);
      }
    }
    if (build_.table.rows() == 0) lines_.Complain(FaultCode::kForeign, "not a single station");
    if (const auto problem = build_.Finish()) lines_.Complain(problem->code, problem->text);
    Conclude();
    return std::move(build_.table);
  }

 private:
  SurveyHead& head() { return build_.table.head; }

  void Header(std::string_view line) {
    if (line.starts_with("# WELL NAME:")) head().names.well = AfterColon(line);
    if (line.starts_with("# DEFINITIVE SURVEY:")) head().names.survey = AfterColon(line);
    if (line.starts_with("# WELL HEAD X-COORDINATE:")) well_x_ = LengthOf(AfterColon(line));
    if (line.starts_with("# WELL HEAD Y-COORDINATE:")) well_y_ = LengthOf(AfterColon(line));
    if (line.starts_with("# WELL DATUM")) {
      datum_ = LengthOf(AfterColon(line));
      if (!datum_) lines_.Complain(FaultCode::kSyntax, "the well datum has no length");
      const std::size_t open = line.find('('), comma = line.find_first_of(",)", open);
      if (open < comma) head().datum = Trim(line.substr(open + 1, comma - open - 1));
      head().vertical_reference = "MSL";
    }
    if (line.starts_with("# XYZ TRACE IS GIVEN IN COORDINATE SYSTEM")) {
      const std::string_view system = Trim(line.substr(41));
      local_ = EqualNoCase(system, "LOCAL");
      if (!local_) head().crs = system;
    }
    if (line.starts_with("# AZIMUTH REFERENCE")) {
      const auto north = NorthOf(line.substr(19));
      if (!north) lines_.Complain(FaultCode::kSyntax, "an azimuth reference that is none");
      head().azimuth.north = *north;
    }
    if (line.starts_with("# DX DY ARE GIVEN IN")) {
      if (const auto north = NorthOf(line.substr(20, line.find(" IN ", 20) - 20))) {
        head().offsets = *north;
        claims_.offsets_north = true;
      }
      across_ = Unit(line);
    }
    if (line.starts_with("# DEPTH")) depths_ = Unit(line);
    if (line.starts_with("# REMARK: ")) AddRemark(head(), std::string(Trim(line.substr(10))));
  }

  std::optional<LengthUnit> Unit(std::string_view line) {
    const std::size_t end = line.find("-UNITS");
    if (end == std::string_view::npos) return std::nullopt;
    const std::size_t begin = line.rfind(' ', end) + 1;
    const auto unit = LengthUnitOf(line.substr(begin, end - begin));
    if (!unit) lines_.Complain(FaultCode::kSyntax, "lengths in a unit that is not known");
    return unit;
  }

  void Columns(std::string_view line) {
    Split(line, ' ', fields_);
    for (const std::string_view name : fields_) names_.emplace_back(name);
    bool md = false, inclination = false;
    for (const std::string& name : names_) {
      md = md || name == "MD";
      inclination = inclination || name == "INCL";
      if (azimuth_.empty() && name.starts_with("AZIM")) azimuth_ = name;
    }
    if (!md || !inclination || azimuth_.empty()) {
      lines_.Complain(FaultCode::kForeign, "no columns MD, INCL and AZIM");
    }
    if (azimuth_ == "AZIM_TN") head().azimuth.north = North::kTrue;
    if (azimuth_ == "AZIM_GN") head().azimuth.north = North::kGrid;
    if (head().offsets == North::kUnknown) head().offsets = North::kGrid;
    SettleUnits();
  }

  void SettleUnits() {
    if (options_.depth_unit) {
      if (depths_ && *depths_ != *options_.depth_unit) {
        head().notes.push_back(
            fmt::format("depths are taken in {} as told, though the file says {}",
                        WordOf(*options_.depth_unit), WordOf(*depths_)));
      }
      if (across_ == depths_) across_ = options_.depth_unit;
      depths_ = options_.depth_unit;
    }
    claims_.md_unit = depths_.has_value();
    claims_.curvature_unit = claims_.md_unit;
    if (!depths_) {
      claims_.open = {Column::kTvd, Column::kDown, Column::kTvdSubSea};
    } else {
      head().md_unit = *depths_;
      if (*depths_ != LengthUnit::kMetre) head().curvature_unit = CurvatureUnit::kDegPer100ft;
    }
    if (!across_) {
      for (const Column c : {Column::kNorth, Column::kEast, Column::kNorthing, Column::kEasting}) {
        claims_.open.push_back(c);
      }
    }
    head().grid_unit = across_.value_or(head().md_unit);
  }

  double FactorFor(Column column) const {
    const double depth = depths_ ? FactorOf(*depths_) : 1;
    switch (column) {
      case Column::kMd:
      case Column::kTvd:
      case Column::kDown:
        return depth;
      case Column::kNorth:
      case Column::kEast:
      case Column::kNorthing:
      case Column::kEasting:
        return across_ ? FactorOf(*across_) : depth;
      case Column::kDogleg:
        return depths_ && *depths_ != LengthUnit::kMetre ? units::kDegPer100ft : units::kDegPer30m;
      default:
        return units::kDeg;
    }
  }

  void Row(std::string_view line) {
    Split(line, ' ', fields_);
    if (fields_.size() != names_.size()) {
      lines_.Complain(FaultCode::kSyntax, fmt::format("{} fields where the header has {}",
                                                      fields_.size(), names_.size()));
    }
    double md = 0;
    std::optional<double> inclination, azimuth;
    std::vector<std::pair<Column, double>> others;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const auto column = ColumnOf(names_[i]);
      if (!column) continue;
      const double number = Number(i), factor = FactorFor(*column);
      if (column == Column::kMd) {
        md = number * factor;
      } else if (column == Column::kInclination) {
        inclination = InclinationOf(number, factor);
      } else if (column == Column::kAzimuth) {
        azimuth = AzimuthOf(number, factor);
      } else {
        const double value = ValueOf(InfoOf(*column).quantity, number, factor);
        others.emplace_back(*column, column == Column::kDown ? -value : value);
      }
    }
    const auto problem = build_.Add(md, inclination, azimuth);
    if (problem) lines_.Complain(problem->code, problem->text);
    for (const auto& [column, value] : others) build_.Set(column, value);
  }

  std::optional<Column> ColumnOf(const std::string& name) const {
    if (name == azimuth_) return Column::kAzimuth;
    for (const NamedColumn& n : kPetrelNames) {
      if (n.name == name) return n.column;
    }
    return std::nullopt;
  }

  double Number(std::size_t i) const {
    const auto number = NumberOf(fields_[i]);
    if (number) return *number;
    lines_.Complain(FaultCode::kSyntax, fmt::format("'{}' is not a number", fields_[i]),
                    static_cast<int>(i) + 1);
  }

  // DX and DY count from the well head, so that X less DX is the head's X. Survey files of ours
  // that begin below the head have its first station's place there.
  void CheckWellHead(const std::optional<Length>& head, const char* axis, Column map, Column own) {
    constexpr double kSame = 0.05;  // of either unit: heads are given to decimetres
    const SurveyTable& table = build_.table;
    const auto at = table.Get(map, 0), moved = table.Get(own, 0);
    if (!head || !at || !moved) return;
    const double factor = FactorFor(map);
    const double said = head->number * (head->unit && across_ ? FactorOf(*head->unit) / factor : 1);
    const double begin = *at / factor, ours = (*at - *moved) / factor;
    // The axes of DX and DY may be turned against the map's by some degrees.
    const double turned = 0.1 * std::abs(*moved) / factor;
    if (std::abs(said - ours) < kSame + turned || std::abs(said - begin) < kSame) return;
    lines_.Complain(
        FaultCode::kConflict,
        fmt::format("the well head lies at {0} {1:.2f} by the file's head, at {2:.2f} by "
                    "{0} less D{0} of the first station: mend the line WELL HEAD "
                    "{0}-COORDINATE, or take it out",
                    axis, said, ours));
  }

  void Conclude() {
    SurveyTable& table = build_.table;
    CheckWellHead(well_x_, "X", Column::kEasting, Column::kEast);
    CheckWellHead(well_y_, "Y", Column::kNorthing, Column::kNorth);
    if (datum_) {
      const auto unit = datum_->unit ? datum_->unit : depths_;
      if (!unit) {
        lines_.Complain(FaultCode::kSyntax,
                        "neither the well datum nor the depths have a unit: say --depth-unit m or "
                        "ft");
      }
      head().datum_elevation = datum_->number * FactorOf(*unit);
    }
    const auto tvd = table.Get(Column::kTvd, 0), down = table.Get(Column::kDown, 0);
    if (tvd && down) claims_.sum_of_tvd_and_z = *tvd - *down;
    if (!local_) return;
    // A local system has no map: its coordinates are offsets.
    if (!table.Has(Column::kNorth) && table.Has(Column::kNorthing)) {
      for (std::size_t row = 0; row < table.rows(); ++row) {
        const auto y = table.Get(Column::kNorthing, row), x = table.Get(Column::kEasting, row);
        if (y) table.Set(Column::kNorth, row, *y);
        if (x) table.Set(Column::kEast, row, *x);
      }
    }
    table.Drop(Column::kNorthing);
    table.Drop(Column::kEasting);
    head().notes.emplace_back("X and Y are local coordinates, not of a map");
  }

  LineReader& lines_;
  const ReadOptions& options_;
  Claims& claims_;
  TableBuilder build_;
  std::vector<std::string> names_;
  std::vector<std::string_view> fields_;
  std::string azimuth_;
  std::optional<LengthUnit> depths_, across_;
  std::optional<Length> datum_, well_x_, well_y_;
  bool local_ = false;
};

using TraceRow = std::array<std::string, 10>;

std::string TraceLine(const TraceRow& cells) {
  std::string line;
  for (const std::string& cell : cells) line += fmt::format(" {:>18}", cell);
  return line + "\n";
}

class PetrelWriter {
 public:
  explicit PetrelWriter(const SurveyTable& table) : table_(table) {}

  std::string Write() const {
    std::string text = Head();
    std::size_t stations = 0;
    text += kRule;
    text += TraceLine({"MD", "X", "Y", "Z", "TVD", "DX", "DY", grid_north_ ? "AZIM_GN" : "AZIM_TN",
                       "INCL", "DLS"});
    text += kRule;
    for (std::size_t row = 0; row < table_.rows(); ++row) {
      if (!OnPath(table_.status(row))) continue;
      text += TraceLine(Station(row));
      ++stations;
    }
    return "# WELL TRACE FROM PETREL\n# " + CertificateText(stations, text) + "\n" + text;
  }

 private:
  std::string Head() const {
    const std::string_view unit = WordOf(head_.md_unit);
    std::string text = "# WELL NAME: " + head_.names.well + "\n";
    if (!head_.names.survey.empty()) text += "# DEFINITIVE SURVEY: " + head_.names.survey + "\n";
    text += fmt::format("# WELL HEAD X-COORDINATE: {} ({})\n", X(0), unit);
    text += fmt::format("# WELL HEAD Y-COORDINATE: {} ({})\n", Y(0), unit);
    text += fmt::format("# WELL DATUM ({}, from MSL): {} ({})\n",
                        head_.datum.empty() ? "KB, Kelly bushing" : head_.datum,
                        Exact(*head_.datum_elevation, factor_), unit);
    text += "# MD AND TVD ARE REFERENCED (=0) AT WELL DATUM AND INCREASE DOWNWARDS\n";
    text += "# ANGLES ARE GIVEN IN DEGREES\n";
    text += fmt::format("# XYZ TRACE IS GIVEN IN COORDINATE SYSTEM {}\n",
                        grid_ ? (head_.crs.empty() ? "UNKNOWN" : head_.crs) : "LOCAL");
    text += fmt::format("# AZIMUTH REFERENCE {} NORTH\n", grid_north_ ? "GRID" : "TRUE");
    text += fmt::format("# DX DY ARE GIVEN IN {} NORTH IN {}-UNITS\n",
                        head_.offsets == North::kTrue ? "TRUE" : "GRID", unit);
    text += fmt::format("# DEPTH (Z, TVD) GIVEN IN {}-UNITS\n", unit);
    for (const std::string& remark : head_.remarks) text += "# REMARK: " + OneLine(remark) + "\n";
    return text;
  }

  TraceRow Station(std::size_t row) const {
    const double below_datum = table_.Get(Column::kTvd, row).value_or(0);
    const double down =
        table_.Get(Column::kDown, row).value_or(below_datum - *head_.datum_elevation);
    const double curvature =
        head_.md_unit == LengthUnit::kMetre ? units::kDegPer30m : units::kDegPer100ft;
    return {Exact(table_.md(row), factor_),
            X(row),
            Y(row),
            Exact(-down, factor_),
            Text(Column::kTvd, row),
            Text(Column::kEast, row),
            Text(Column::kNorth, row),
            Exact(Quantity::kDirection, table_.azimuth(row), head_),
            Exact(table_.inclination(row), units::kDeg),
            Exact(table_.Get(Column::kDogleg, row).value_or(0), curvature)};
  }

  std::string X(std::size_t row) const {
    return Text(grid_ ? Column::kEasting : Column::kEast, row);
  }
  std::string Y(std::size_t row) const {
    return Text(grid_ ? Column::kNorthing : Column::kNorth, row);
  }

  std::string Text(Column column, std::size_t row) const {
    const auto value = table_.Get(column, row);
    if (!value) {
      Lacks("Petrel",
            fmt::format("{} in every row; row {} has none", InfoOf(column).text, row + 1));
    }
    return Exact(*value, factor_);
  }

  const SurveyTable& table_;
  const SurveyHead& head_ = table_.head;
  double factor_ = FactorOf(head_.md_unit);
  bool grid_ = table_.Has(Column::kNorthing) && table_.Has(Column::kEasting);
  bool grid_north_ = head_.azimuth.north == North::kGrid;
};

}  // namespace

SurveyTable ReadPetrel(LineReader& lines, const ReadOptions& options, Claims& claims) {
  return PetrelReader(lines, options, claims).Read();
}

std::string WritePetrel(const SurveyTable& table) {
  NeedNorth(table, "Petrel");
  const SurveyHead& head = table.head;
  if (head.azimuth.north == North::kMagnetic) Lacks("Petrel", "azimuths from true or grid north");
  if (!head.datum_elevation) {
    Lacks("Petrel", "the elevation of the depth datum (datum_elevation_m)");
  }
  if (table.rows() == 0 || !table.Get(Column::kTvd, 0) || !table.Get(Column::kNorth, 0)) {
    Lacks("Petrel", "positions");
  }
  return PetrelWriter(table).Write();
}

}  // namespace wellgyro
