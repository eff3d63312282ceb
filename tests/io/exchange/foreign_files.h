#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/earth/grid.h"

namespace wellgyro::foreign {

/// The truth of a well, from which files are made: metres and degrees, azimuths and offsets from
/// grid north.
struct Well {
  std::string name;
  std::vector<double> md, inclination, azimuth;
  std::vector<double> north, east, tvd, dogleg;  ///< by Sum; dogleg in deg/30m
  double convergence = 0, declination = 0;
  double elevation = 0, northing = 0, easting = 0;
};

/// Sums positions by the centre of each leg's arc in long double, another way than the library's.
void Sum(Well& well);

/// A table as a file shows it.
struct SheetColumn {
  std::string name, unit;
  int decimals = 2;
  std::vector<double> values;
  std::vector<std::string> cells = {};  ///< in place of a value where not empty
};
struct Sheet {
  std::vector<SheetColumn> columns;
  std::optional<double> convergence, declination, elevation;
  std::string elevation_unit = "m";
  North north = North::kGrid;  ///< what the head says of the azimuths, where it says so

  SheetColumn& At(const std::string& name);
  void Drop(const std::string& name);
};

enum class Look { kBrackets, kUnitLine, kTabs, kLas, kReport, kPreamble };

/// MD, INC, AZI, TVD, N, E, DLS, and northing, easting and TVDSS where wanted, in `unit`.
Sheet SheetOf(const Well& well, const std::string& unit, bool map);
std::string TextOf(const Sheet& sheet, Look look, const std::string& well);

}  // namespace wellgyro::foreign
