#include "foreign_files.h"

#include <cmath>
#include <stdexcept>

#include <fmt/core.h>

namespace wellgyro::foreign {
namespace {

using Real = long double;
constexpr Real kDegree = 3.14159265358979323846264338327950288L / 180;

struct Vector {
  Real n, e, d;
};

Vector TangentOf(double inclination, double azimuth) {
  const Real i = inclination * kDegree, a = azimuth * kDegree;
  return {std::sin(i) * std::cos(a), std::sin(i) * std::sin(a), std::cos(i)};
}

double Length(double metres, const std::string& unit) {
  return unit == "ft" ? metres / 0.3048 : metres;
}

std::vector<double> Scaled(const std::vector<double>& values, const std::string& unit,
                           double add = 0) {
  std::vector<double> scaled;
  for (const double v : values) scaled.push_back(Length(v + add, unit));
  return scaled;
}

std::string Cell(const SheetColumn& column, std::size_t row) {
  if (row < column.cells.size() && !column.cells[row].empty()) return column.cells[row];
  return fmt::format("{:.{}f}", column.values[row], column.decimals);
}

std::string Rows(const Sheet& sheet, const std::string& between, int width) {
  std::string text;
  for (std::size_t row = 0; row < sheet.columns.front().values.size(); ++row) {
    std::string line;
    for (const SheetColumn& column : sheet.columns) {
      line += (line.empty() ? "" : between) + fmt::format("{:>{}}", Cell(column, row), width);
    }
    text += line + "\n";
  }
  return text;
}

std::string NorthWord(North north) {
  return north == North::kGrid ? "Grid" : north == North::kTrue ? "True" : "Magnetic";
}

std::string Heading(const Sheet& sheet, const SheetColumn& column) {
  if (column.name != "AZI" || sheet.north == North::kUnknown) return column.name;
  return sheet.north == North::kGrid   ? "AZI_GRID"
         : sheet.north == North::kTrue ? "AZI_TRUE"
                                       : "AZI_MAG";
}

std::string Preamble(const Sheet& sheet) {
  std::string text;
  if (sheet.convergence) text += fmt::format("# grid_convergence_deg: {}\n", *sheet.convergence);
  if (sheet.declination) text += fmt::format("# declination_deg: {}\n", *sheet.declination);
  if (sheet.elevation) text += fmt::format("# datum_elevation_m: {}\n", *sheet.elevation);
  return text;
}

std::string Table(const Sheet& sheet, const std::string& between, bool units_apart) {
  std::string names, units;
  for (const SheetColumn& column : sheet.columns) {
    const std::string start = names.empty() ? "" : between;
    const bool inside = !units_apart && !column.unit.empty();
    names += start + Heading(sheet, column) + (inside ? "[" + column.unit + "]" : "");
    units += start + column.unit;
  }
  return Preamble(sheet) + names + "\n" + (units_apart ? units + "\n" : "") +
         Rows(sheet, between, 0);
}

std::string Las(const Sheet& sheet, const std::string& well) {
  std::string text = "~V\n VERS. 2.0 : \n WRAP. NO : \n~W\n";
  const SheetColumn& md = sheet.columns.front();
  text += fmt::format(" STRT.{} {} : \n STOP.{} {} : \n STEP.{} 0 : \n NULL. -999.25 : \n", md.unit,
                      Cell(md, 0), md.unit, Cell(md, md.values.size() - 1), md.unit);
  text += " WELL. " + well + " : \n~P\n";
  if (sheet.north != North::kUnknown) text += " I_AT. " + NorthWord(sheet.north) + " : \n";
  if (sheet.convergence) text += fmt::format(" I_GC.DEG {} : \n", *sheet.convergence);
  if (sheet.declination) text += fmt::format(" I_DC.DEG {} : \n", *sheet.declination);
  if (sheet.elevation) text += fmt::format(" I_RF.M {} : \n", *sheet.elevation);
  text += "~C\n";
  for (const SheetColumn& column : sheet.columns) {
    const std::string name = column.name == "MD"    ? "DEPT"
                             : column.name == "INC" ? "DEVI"
                             : column.name == "AZI" ? "AZIM"
                             : column.name == "N"   ? "NSDR"
                             : column.name == "E"   ? "EWDR"
                                                    : column.name;
    text += fmt::format(" {}.{} : \n", name, column.unit);
  }
  return text + "~A\n" + Rows(sheet, " ", 12);
}

std::string Report(const Sheet& sheet, const std::string& well) {
  std::string text = "Survey Report\n\nWell:  " + well + "\n";
  if (sheet.north != North::kUnknown) {
    text += "North Reference:   " + NorthWord(sheet.north) + "\n";
  }
  if (sheet.elevation) {
    const double shown = Length(*sheet.elevation, sheet.elevation_unit);
    for (const std::string key : {"MD Reference", "TVD Reference"}) {
      text += fmt::format("{}:   RT @ {:.4f}{} above MSL\n", key, shown, sheet.elevation_unit);
    }
  }
  if (sheet.convergence) text += fmt::format("Grid Convergence: {} deg\n", *sheet.convergence);
  if (sheet.declination) text += fmt::format("Magnetic Declination: {} deg\n", *sheet.declination);
  std::string names, units;
  for (const SheetColumn& column : sheet.columns) {
    names += fmt::format(" {:>12}", column.name == "N"   ? "+N/-S"
                                    : column.name == "E" ? "+E/-W"
                                                         : column.name);
    units += fmt::format(" {:>12}", "(" + column.unit + ")");
  }
  return text + "\n" + names + "\n" + units + "\n" + Rows(sheet, " ", 12);
}

}  // namespace

void Sum(Well& well) {
  Vector p{0, 0, 0};
  well.north = {0}, well.east = {0}, well.tvd = {0}, well.dogleg = {0};
  for (std::size_t k = 1; k < well.md.size(); ++k) {
    const Vector a = TangentOf(well.inclination[k - 1], well.azimuth[k - 1]);
    const Vector b = TangentOf(well.inclination[k], well.azimuth[k]);
    const Real chord = std::sqrt((a.n - b.n) * (a.n - b.n) + (a.e - b.e) * (a.e - b.e) +
                                 (a.d - b.d) * (a.d - b.d));
    const Real half = std::asin(chord / 2), length = well.md[k] - well.md[k - 1];
    const Real step = length / 2 * (half > 1e-9L ? std::tan(half) / half : 1);
    p = {p.n + step * (a.n + b.n), p.e + step * (a.e + b.e), p.d + step * (a.d + b.d)};
    well.north.push_back(static_cast<double>(p.n));
    well.east.push_back(static_cast<double>(p.e));
    well.tvd.push_back(static_cast<double>(p.d));
    well.dogleg.push_back(static_cast<double>(2 * half / kDegree / length * 30));
  }
}

SheetColumn& Sheet::At(const std::string& name) {
  for (SheetColumn& column : columns) {
    if (column.name == name) return column;
  }
  throw std::logic_error("no column " + name);
}

void Sheet::Drop(const std::string& name) {
  std::erase_if(columns, [&](const SheetColumn& c) { return c.name == name; });
}

Sheet SheetOf(const Well& well, const std::string& unit, bool map) {
  std::vector<double> dogleg;
  const double per = unit == "ft" ? 30.48 / 30 : 1;
  for (const double v : well.dogleg) dogleg.push_back(v * per);
  Sheet sheet;
  sheet.columns = {{"MD", unit, 2, Scaled(well.md, unit)},
                   {"INC", "deg", 2, well.inclination},
                   {"AZI", "deg", 2, well.azimuth},
                   {"TVD", unit, 2, Scaled(well.tvd, unit)},
                   {"N", unit, 2, Scaled(well.north, unit)},
                   {"E", unit, 2, Scaled(well.east, unit)},
                   {"DLS", unit == "ft" ? "deg/100ft" : "deg/30m", 3, dogleg}};
  if (map) {
    sheet.columns.push_back({"NORTHING", unit, 2, Scaled(well.north, unit, well.northing)});
    sheet.columns.push_back({"EASTING", unit, 2, Scaled(well.east, unit, well.easting)});
    sheet.columns.push_back({"TVDSS", unit, 2, Scaled(well.tvd, unit, -well.elevation)});
  }
  sheet.convergence = well.convergence;
  sheet.declination = well.declination;
  sheet.elevation = well.elevation;
  return sheet;
}

std::string TextOf(const Sheet& sheet, Look look, const std::string& well) {
  switch (look) {
    case Look::kUnitLine:
      return Table(sheet, ",", true);
    case Look::kTabs:
      return Table(sheet, "\t", true);
    case Look::kLas:
      return Las(sheet, well);
    case Look::kReport:
      return Report(sheet, well);
    default:
      return Table(sheet, look == Look::kPreamble ? ";" : ",", false);
  }
}

}  // namespace wellgyro::foreign
