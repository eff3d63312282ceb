#include "planted_errors.h"

#include <cmath>
#include <initializer_list>

#include "wellgyro/base/angle.h"

namespace wellgyro::foreign {
namespace {

void Scale(Sheet& sheet, std::initializer_list<const char*> names, double factor) {
  for (const char* name : names) {
    for (double& v : sheet.At(name).values) v *= factor;
  }
}
void Shift(Sheet& sheet, const char* name, double by) {
  for (double& v : sheet.At(name).values) v += by;
}
double FactorIn(const Sheet& sheet) { return sheet.columns[0].unit == "ft" ? 1 / 0.3048 : 1; }
double Other(const Sheet& sheet) { return sheet.columns[0].unit == "ft" ? 0.3048 : 1 / 0.3048; }
void SetCell(Sheet& sheet, const char* name, const Well& well, const char* text) {
  auto& column = sheet.At(name);
  column.cells.resize(column.values.size());
  column.cells[well.md.size() * 2 / 3] = text;
}
void TurnOffsets(Sheet& sheet, double degrees) {
  const double c = std::cos(FromDegrees(degrees)), s = std::sin(FromDegrees(degrees));
  auto& north = sheet.At("N").values;
  auto& east = sheet.At("E").values;
  for (std::size_t k = 0; k < north.size(); ++k) {
    const double n = north[k] * c - east[k] * s, e = north[k] * s + east[k] * c;
    north[k] = n, east[k] = e;
  }
}
void TurnAzimuths(Sheet& sheet, double degrees) {
  for (double& v : sheet.At("AZI").values) v = std::fmod(v + degrees + 720, 360);
}

}  // namespace

std::vector<Planted> UnitErrors() {
  return {
      {"TVD in another unit", false, [](Sheet& s, const Well&) { Scale(s, {"TVD"}, Other(s)); }},
      {"MD in another unit", false, [](Sheet& s, const Well&) { Scale(s, {"MD"}, Other(s)); }},
      {"offsets in another unit", false,
       [](Sheet& s, const Well&) {
         Scale(s, {"N", "E"}, Other(s));
       }},
      {"all lengths in another unit than they say", false,
       [](Sheet& s, const Well&) {
         Scale(s, {"MD", "TVD", "N", "E"}, Other(s));
       }},
      {"map coordinates in another unit", true,
       [](Sheet& s, const Well&) {
         Scale(s, {"NORTHING", "EASTING"}, Other(s));
       }},
      {"positions without unit in another one", false,
       [](Sheet& s, const Well&) {
         Scale(s, {"TVD", "N", "E"}, Other(s));
         for (const char* name : {"TVD", "N", "E"}) s.At(name).unit.clear();
       }},
      {"no unit of depth", false,
       [](Sheet& s, const Well&) {
         for (const char* name : {"MD", "TVD", "N", "E", "DLS"}) s.At(name).unit.clear();
       }},
      {"no unit of depth, others said", false,
       [](Sheet& s, const Well&) { s.At("MD").unit.clear(); }},
  };
}

std::vector<Planted> NorthErrors() {
  return {
      {"true azimuths called grid", false,
       [](Sheet& s, const Well& w) { TurnAzimuths(s, w.convergence); }},
      {"grid azimuths called true beside a map", true,
       [](Sheet& s, const Well&) { s.north = North::kTrue; }},
      {"magnetic azimuths called grid", false,
       [](Sheet& s, const Well& w) { TurnAzimuths(s, w.convergence - w.declination); }},
      {"convergence of the wrong sign", true,
       [](Sheet& s, const Well& w) {
         TurnAzimuths(s, w.convergence);
         s.north = North::kTrue;
         s.convergence = -w.convergence;
       }},
      {"convergence unsaid, grid azimuths called true", true,
       [](Sheet& s, const Well&) {
         s.convergence.reset();
         s.north = North::kTrue;
       }},
      {"north unsaid beside a map", true, [](Sheet& s, const Well&) { s.north = North::kUnknown; }},
      {"true azimuths, north unsaid, beside a map", true,
       [](Sheet& s, const Well& w) {
         TurnAzimuths(s, w.convergence);
         s.north = North::kUnknown;
         s.Drop("N");
         s.Drop("E");
       }},
      {"offsets from true, azimuths from grid north", false,
       [](Sheet& s, const Well& w) { TurnOffsets(s, w.convergence); }},
      {"offsets from a north that nothing tells", false,
       [](Sheet& s, const Well& w) {
         TurnOffsets(s, w.convergence);
         s.convergence.reset();
       }},
  };
}

std::vector<Planted> DatumErrors() {
  return {
      {"TVD from sea level", false,
       [](Sheet& s, const Well& w) { Shift(s, "TVD", -w.elevation * FactorIn(s)); }},
      {"TVD from the ground", false,
       [](Sheet& s, const Well&) { Shift(s, "TVD", -7.3 * FactorIn(s)); }},
      {"TVD from above the datum", false,
       [](Sheet& s, const Well&) { Shift(s, "TVD", 4.1 * FactorIn(s)); }},
      {"elevation in another unit", true,
       [](Sheet& s, const Well&) { s.elevation = *s.elevation / 0.3048; }},
      {"elevation of another datum", true,
       [](Sheet& s, const Well&) { s.elevation = *s.elevation - 12.5; }},
      {"elevation unsaid", true, [](Sheet& s, const Well&) { s.elevation.reset(); }},
      {"TVD upwards", false, [](Sheet& s, const Well&) { Scale(s, {"TVD"}, -1); }},
      {"TVDSS upwards", true, [](Sheet& s, const Well&) { Scale(s, {"TVDSS"}, -1); }},
  };
}

std::vector<Planted> OffsetErrors() {
  return {
      {"north and east exchanged", false,
       [](Sheet& s, const Well&) { std::swap(s.At("N").values, s.At("E").values); }},
      {"east of the wrong sign", false, [](Sheet& s, const Well&) { Scale(s, {"E"}, -1); }},
      {"north of the wrong sign", false, [](Sheet& s, const Well&) { Scale(s, {"N"}, -1); }},
      {"both of the wrong sign", false,
       [](Sheet& s, const Well&) {
         Scale(s, {"N", "E"}, -1);
       }},
      {"map coordinates as offsets", false,
       [](Sheet& s, const Well& w) {
         Shift(s, "N", w.northing * FactorIn(s));
         Shift(s, "E", w.easting * FactorIn(s));
       }},
      {"northing and easting exchanged", true,
       [](Sheet& s, const Well&) { std::swap(s.At("NORTHING").values, s.At("EASTING").values); }},
      {"another well's offsets", false, [](Sheet& s, const Well&) { TurnOffsets(s, 47); }},
  };
}

std::vector<Planted> NullErrors() {
  std::vector<Planted> planted;
  for (const char* column : {"INC", "AZI", "TVD", "N", "E"}) {
    for (const char* null : {"-999.25", "-9999", "-999", "9999"}) {
      planted.push_back({std::string(null) + " for " + column, false,
                         [=](Sheet& s, const Well& w) { SetCell(s, column, w, null); }});
    }
  }
  planted.push_back(
      {"0 for TVD", false, [](Sheet& s, const Well& w) { SetCell(s, "TVD", w, "0"); }});
  planted.push_back(
      {"-999.25 for MD", false, [](Sheet& s, const Well& w) { SetCell(s, "MD", w, "-999.25"); }});
  planted.push_back({"N of 9999 at the second station", false, [](Sheet& s, const Well&) {
                       auto& north = s.At("N");
                       north.cells.resize(north.values.size());
                       north.cells[1] = "9999";
                     }});
  return planted;
}

}  // namespace wellgyro::foreign
