// "WELL TRACE FROM PETREL", as Petrel exports and many open readers take it.
#include <array>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
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

// Number and unit of "25.0 (m)".
struct Length {
  double value = 0;  // [m]
  LengthUnit unit = LengthUnit::kMetre;
};
std::optional<Length> LengthOf(std::string_view text) {
  const std::size_t open = text.find('(');
  const auto number = NumberOf(text.substr(0, open));
  if (!number || open == std::string_view::npos) return std::nullopt;
  const auto unit = LengthUnitOf(text.substr(open + 1, text.find(')') - open - 1));
  if (!unit) return std::nullopt;
  return Length{*number * FactorOf(*unit), *unit};
}

class PetrelReader {
 public:
  explicit PetrelReader(LineReader& lines) : lines_(lines) {}

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
    return std::move(build_.table);
  }

 private:
  SurveyHead& head() { return build_.table.head; }

  void Header(std::string_view line) {
    if (line.starts_with("# WELL NAME:")) head().names.well = AfterColon(line);
    if (line.starts_with("# DEFINITIVE SURVEY:")) head().names.survey = AfterColon(line);
    if (line.starts_with("# REMARK:")) head().remarks.emplace_back(AfterColon(line));
    if (line.starts_with("# WELL DATUM")) {
      const auto length = LengthOf(AfterColon(line));
      if (!length) lines_.Complain(FaultCode::kSyntax, "the well datum has no length with a unit");
      head().datum_elevation = length->value;
      const std::size_t open = line.find('('), comma = line.find_first_of(",)", open);
      if (open < comma) head().datum = Trim(line.substr(open + 1, comma - open - 1));
      head().vertical_reference = "MSL";
    }
    if (line.starts_with("# XYZ TRACE IS GIVEN IN COORDINATE SYSTEM")) {
      head().crs = Trim(line.substr(41));
    }
    if (line.starts_with("# AZIMUTH REFERENCE")) {
      const auto north = NorthOf(line.substr(19));
      if (!north) lines_.Complain(FaultCode::kSyntax, "an azimuth reference that is none");
      head().azimuth.north = *north;
    }
    if (line.starts_with("# DX DY ARE GIVEN IN")) {
      if (const auto north = NorthOf(line.substr(20, line.find(" IN ", 20) - 20))) {
        head().offsets = *north;
      }
      Unit(line);
    }
    if (line.starts_with("# DEPTH")) Unit(line);
  }

  void Unit(std::string_view line) {
    const std::size_t end = line.find("-UNITS");
    if (end == std::string_view::npos) return;
    const std::size_t begin = line.rfind(' ', end) + 1;
    const auto unit = LengthUnitOf(line.substr(begin, end - begin));
    if (!unit) lines_.Complain(FaultCode::kSyntax, "lengths in a unit that is not known");
    head().md_unit = head().grid_unit = *unit;
    if (*unit != LengthUnit::kMetre) head().curvature_unit = CurvatureUnit::kDegPer100ft;
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
  }

  void Row(std::string_view line) {
    Split(line, ' ', fields_);
    if (fields_.size() != names_.size()) {
      lines_.Complain(FaultCode::kSyntax, fmt::format("{} fields where the header has {}",
                                                      fields_.size(), names_.size()));
    }
    std::array<double, 3> station{};
    std::vector<std::pair<Column, double>> others;
    for (std::size_t i = 0; i < fields_.size(); ++i) Cell(i, station, others);
    const auto problem = build_.Add(station[0], station[1], station[2]);
    if (problem) lines_.Complain(problem->code, problem->text);
    for (const auto& [column, value] : others) build_.Set(column, value);
  }

  void Cell(std::size_t i, std::array<double, 3>& station,
            std::vector<std::pair<Column, double>>& others) {
    constexpr std::array kNames{NamedColumn{"MD", Column::kMd},
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
    Column column = Column::kAzimuth;
    bool known = names_[i] == azimuth_;
    for (const NamedColumn& n : kNames) {
      if (!known && n.name == names_[i]) {
        column = n.column;
        known = true;
      }
    }
    if (!known) return;
    const auto number = NumberOf(fields_[i]);
    if (!number) {
      lines_.Complain(FaultCode::kSyntax, fmt::format("'{}' is not a number", fields_[i]),
                      static_cast<int>(i) + 1);
    }
    const Quantity quantity = InfoOf(column).quantity;
    double value = ValueOf(quantity, *number, FactorOf(quantity, head()));
    if (column == Column::kDown) value = -value;
    if (column <= Column::kAzimuth) {
      station[static_cast<std::size_t>(column)] = value;
    } else {
      others.emplace_back(column, value);
    }
  }

  LineReader& lines_;
  TableBuilder build_;
  std::vector<std::string> names_;
  std::vector<std::string_view> fields_;
  std::string azimuth_;
};

using Row = std::array<std::string, 10>;

std::string Line(const Row& cells) {
  std::string line;
  for (const std::string& cell : cells) line += fmt::format(" {:>18}", cell);
  return line + "\n";
}

class PetrelWriter {
 public:
  explicit PetrelWriter(const SurveyTable& table) : table_(table) {}

  std::string Write() const {
    std::string text = Head();
    text += kRule;
    text += Line({"MD", "X", "Y", "Z", "TVD", "DX", "DY", grid_north_ ? "AZIM_GN" : "AZIM_TN",
                  "INCL", "DLS"});
    text += kRule;
    for (std::size_t row = 0; row < table_.rows(); ++row) {
      if (OnPath(table_.status(row))) text += Line(Station(row));
    }
    return text;
  }

 private:
  std::string Head() const {
    const std::string_view unit = WordOf(head_.md_unit);
    std::string text = "# WELL TRACE FROM PETREL\n";
    text += "# WELL NAME: " + head_.names.well + "\n";
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

  Row Station(std::size_t row) const {
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

SurveyTable ReadPetrel(LineReader& lines) { return PetrelReader(lines).Read(); }

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
