// Depths with their datum, and offsets and map coordinates with their axes and norths.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/exchange/columns_internal.h"
#include "wellgyro/io/exchange/headings_internal.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/exchange/witness_case_internal.h"
#include "wellgyro/math/median.h"

namespace wellgyro::witness {
namespace {

constexpr double kSame = 0.05;  // [m]; files round to centimetres, heads to decimetres
constexpr double kEnough = 20;  // [m]; of path, that positions which do not follow from it show

std::optional<std::size_t> FirstWith(const SurveyTable& table, Column column) {
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.status(row) != RowStatus::kUnused && table.Get(column, row)) return row;
  }
  return std::nullopt;
}

// Median of a less b over the rows that have both.
std::optional<double> TypicalDifference(const SurveyTable& table, Column a, Column b) {
  std::vector<double> differences;
  const std::size_t step = table.rows() / 4096 + 1;
  for (std::size_t row = 0; row < table.rows(); row += step) {
    const auto x = table.Get(a, row), y = table.Get(b, row);
    if (x && y) differences.push_back(*x - *y);
  }
  if (differences.empty()) return std::nullopt;
  return Median(std::move(differences));
}

// True less grid azimuth, as the head says it or two columns of azimuths do.
std::optional<double> ConvergenceOf(const SurveyTable& table) {
  const AzimuthReference& reference = table.head.azimuth;
  if (reference.convergence) return reference.convergence;
  const std::size_t row = table.rows() / 2;
  const auto value = [&](North north, Column column) -> std::optional<double> {
    if (reference.north == north) return table.azimuth(row);
    return table.Get(column, row);
  };
  const auto from_true = value(North::kTrue, Column::kAzimuthTrue);
  const auto from_grid = value(North::kGrid, Column::kAzimuthGrid);
  if (!from_true || !from_grid) return std::nullopt;
  return WrapPi(*from_true - *from_grid);
}

// How far a direction that counts from `from` grows when it counts from `to`.
std::optional<double> TurnOf(AzimuthReference reference, const std::optional<double>& convergence,
                             North from, North to) {
  if (from == to) return 0;
  reference.convergence = convergence;
  try {
    return WrapPi(AzimuthFrom(reference, 0, from, to));
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

// The same, or as two columns of azimuths beside each other show it.
std::optional<double> TurnIn(const SurveyTable& table, North from, North to) {
  const AzimuthReference& reference = table.head.azimuth;
  const auto stated = TurnOf(reference, ConvergenceOf(table), from, to);
  if (stated) return stated;
  const std::size_t row = table.rows() / 2;
  const auto value = [&](North north) -> std::optional<double> {
    if (reference.north == north) return table.azimuth(row);
    const auto column = SecondAzimuth(north);
    return column ? table.Get(*column, row) : std::nullopt;
  };
  const auto a = value(from), b = value(to);
  if (!a || !b) return std::nullopt;
  return WrapPi(*b - *a);
}

double Degrees(double radians) { return std::round(ToDegrees(radians) * 1e3) / 1e3; }

// TVD counts from the datum of MD: where MD is 0 it is 0 too, and nowhere is it deeper than MD.
void CheckDatum(Case& c) {
  const auto row = FirstWith(c.table, Column::kTvd);
  if (!row) return;
  const double tvd = *c.table.Get(Column::kTvd, *row), md = c.table.md(*row);
  const auto& elevation = c.table.head.datum_elevation;
  const bool begins = std::abs(md) < kSame;
  if (begins ? std::abs(tvd) < kSame : tvd < md + kSame) return;
  if (begins && elevation && std::abs(tvd + *elevation) < kSame) {
    for (std::size_t i = 0; i < c.table.rows(); ++i) {
      const auto value = c.table.Get(Column::kTvd, i);
      if (!value) continue;
      c.table.Set(Column::kTvdSubSea, i, *value);
      c.table.Set(Column::kTvd, i, *value + *elevation);
    }
    c.Note(fmt::format(
        "TVD counts from mean sea level in the file, {:.2f} m below the datum of MD; here from "
        "that datum",
        *elevation));
    return;
  }
  c.Refuse(fmt::format(
      "TVD is {:.2f} m where MD is {:.2f} m: it counts from another datum than MD; say which "
      "column it is by --columns TVDSS=..., or leave it out by --columns TVD=0",
      tvd, md));
}

void CheckElevation(Case& c) {
  for (const Column column : {Column::kTvdSubSea, Column::kDown}) {
    const auto elevation = TypicalDifference(c.table, Column::kTvd, column);
    if (!elevation) continue;
    auto& stated = c.table.head.datum_elevation;
    if (!stated) {
      stated = std::round(*elevation * 1e4) / 1e4;
      c.Note(fmt::format("the datum lies {:.2f} m above the vertical reference, as TVD and {} show",
                         *elevation, InfoOf(column).text));
    } else if (std::abs(*stated - *elevation) > kSame) {
      c.Refuse(fmt::format(
          "the datum lies {:.2f} m above the vertical reference by the head, {:.2f} m by TVD and "
          "{}: say which by --datum-elevation-m",
          *stated, *elevation, InfoOf(column).text));
    }
  }
}

// Z is a depth in some files and a height in others.
void TurnHeights(Case& c) {
  const LineFit fit = FitVertical(c.table, c.stretches, Column::kDown);
  if (!Tells(fit) || fit.factor > 0) return;
  for (std::size_t row = 0; row < c.table.rows(); ++row) {
    if (const auto z = c.table.Get(Column::kDown, row)) c.table.Set(Column::kDown, row, -*z);
  }
  c.Note("Z falls along the hole: it is taken for a height");
}

// Depths below the vertical reference, where there is no TVD to hold them to.
void CheckOtherDepths(Case& c) {
  if (c.table.Has(Column::kTvd)) return;
  for (const Column column : {Column::kTvdSubSea, Column::kDown}) {
    const LineFit fit = FitVertical(c.table, c.stretches, column);
    const std::string name(InfoOf(column).text);
    if (fit.reach > kEnough && fit.sigma >= 0.05) {
      c.Refuse(
          fmt::format("{} does not follow from measured depth and inclination: name the "
                      "columns by --columns",
                      name));
    }
    if (!Tells(fit)) continue;
    if (fit.factor < 0) {
      c.Refuse(fmt::format("{} grows upwards: it is a height; leave it out by --columns {}=0", name,
                           InfoOf(column).csv));
    }
    c.agreeing.push_back(name);
  }
}

struct Plane {
  Column north, east;
  bool map;
  std::string_view name;
};
constexpr std::array kPlanes{
    Plane{Column::kNorth, Column::kEast, false, "north and east"},
    Plane{Column::kNorthing, Column::kEasting, true, "northing and easting"}};

// Large numbers are no offsets.
void MoveMapCoordinates(Case& c) {
  // [m]: no hole goes 100 km aside, and grids give their origins false eastings and northings above
  // it.
  constexpr double kFarthest = 1e5;
  const auto row = FirstWith(c.table, Column::kNorth);
  if (!row || c.table.Has(Column::kNorthing)) return;
  const double north = *c.table.Get(Column::kNorth, *row);
  const double east = c.table.Get(Column::kEast, *row).value_or(0);
  if (std::max(std::abs(north), std::abs(east)) < kFarthest) return;
  for (std::size_t i = 0; i < c.table.rows(); ++i) {
    if (const auto n = c.table.Get(Column::kNorth, i)) c.table.Set(Column::kNorthing, i, *n);
    if (const auto e = c.table.Get(Column::kEast, i)) c.table.Set(Column::kEasting, i, *e);
  }
  c.table.Drop(Column::kNorth);
  c.table.Drop(Column::kEast);
  c.Note(fmt::format("north of {:.0f} m and east of {:.0f} m are map coordinates, not offsets",
                     north, east));
}

void Exchange(Case& c, const Plane& plane) {
  for (std::size_t row = 0; row < c.table.rows(); ++row) {
    const auto n = c.table.Get(plane.north, row), e = c.table.Get(plane.east, row);
    if (!n || !e) continue;
    c.table.Set(plane.north, row, *e);
    c.table.Set(plane.east, row, *n);
  }
}

// Axes in the wrong order or of the wrong sign make a mirror image, or turn by half a circle.
void CheckAxes(Case& c, const Plane& plane, PlaneFit& fit, double tolerance) {
  const double turn = std::arg(fit.z), mirror = std::arg(fit.mirrored);
  const auto is = [&](double angle, double wanted) {
    return std::abs(WrapPi(angle - wanted)) < tolerance + FromDegrees(5);
  };
  const bool direct_fits = Tells(fit) && fit.median <= fit.mirrored_median * 1.5 + 1e-9;
  if (direct_fits && std::abs(turn) < FromDegrees(45)) return;
  if (direct_fits && is(turn, kPi)) {
    c.Refuse(fmt::format("{} grow southwards and westwards: name them by --columns", plane.name));
  }
  if (fit.mirrored_median > 2 * fit.median + 0.02) return;
  if (is(mirror, kPi / 2)) {
    if (c.claims.axes_named) {
      c.Refuse(
          fmt::format("{} are exchanged, by measured depth, inclination and azimuth: name the "
                      "columns by --columns N=...,E=...",
                      plane.name));
    }
    Exchange(c, plane);
    c.Note("X is the north and Y the east, as measured depth, inclination and azimuth show");
    fit = FitPlane(c.table, c.stretches, plane.north, plane.east);
  } else if (is(mirror, 0) || is(mirror, kPi)) {
    c.Refuse(fmt::format("{} has the wrong sign, by measured depth, inclination and azimuth",
                         is(mirror, 0) ? "the east" : "the north"));
  }
}

[[noreturn]] void DoesNotFollow(const Case& c, const Plane& plane) {
  c.Refuse(
      fmt::format("{} do not follow from measured depth, inclination and azimuth: name the "
                  "columns by --columns, or leave them out by --columns N=0,E=0",
                  plane.name));
}

// The norths from which a plane's directions may count, given how it is turned.
std::vector<North> NorthsThatFit(const Case& c, double turn, double tolerance) {
  std::vector<North> fitting;
  for (const North north : {North::kTrue, North::kGrid, North::kMagnetic}) {
    const auto wanted = TurnIn(c.table, c.table.head.azimuth.north, north);
    if (wanted && std::abs(WrapPi(turn - *wanted)) <= tolerance) fitting.push_back(north);
  }
  return fitting;
}

void SettleAzimuthNorth(Case& c, double turn, double tolerance) {
  AzimuthReference& reference = c.table.head.azimuth;
  std::vector<North> fitting;
  for (const North north : {North::kTrue, North::kGrid, North::kMagnetic}) {
    const auto wanted = TurnOf(reference, ConvergenceOf(c.table), north, North::kGrid);
    if (wanted && std::abs(WrapPi(turn - *wanted)) <= tolerance) fitting.push_back(north);
  }
  // Where true and grid north are one, azimuths from either are azimuths from the grid's.
  const bool grid = std::find(fitting.begin(), fitting.end(), North::kGrid) != fitting.end();
  if (!grid && fitting.size() != 1) return;
  reference.north = grid ? North::kGrid : fitting.front();
  if (c.table.head.offsets == North::kUnknown) c.table.head.offsets = reference.north;
  c.Note(fmt::format("azimuths count from {} north, as northing and easting show",
                     WordOf(reference.north)));
}

void CheckMapNorth(Case& c, double turn, double tolerance) {
  const AzimuthReference& reference = c.table.head.azimuth;
  if (reference.north == North::kUnknown) return SettleAzimuthNorth(c, turn, tolerance);
  const auto wanted = TurnIn(c.table, reference.north, North::kGrid);
  if (wanted && std::abs(WrapPi(turn - *wanted)) <= tolerance) {
    return c.agreeing.emplace_back("northing and easting"), void();
  }
  if (wanted) {
    c.Refuse(fmt::format(
        "northing and easting are turned by {} deg against the azimuths, not by {} as azimuths "
        "from {} north would be: say --azimuth-reference, --convergence-deg or --declination-deg",
        Degrees(turn), Degrees(*wanted), WordOf(reference.north)));
  }
  if (std::abs(turn) <= tolerance) {
    c.Refuse(fmt::format(
        "azimuths are said to count from {} north, but agree with northing and easting as if from "
        "grid north: say --azimuth-reference grid, or --convergence-deg 0 where true north is grid "
        "north",
        WordOf(reference.north)));
  }
  c.Note(
      fmt::format("northing and easting are turned by {} deg against the azimuths, which the "
                  "file does not explain: neither convergence nor declination is stated",
                  Degrees(turn)));
}

void CheckOffsetNorth(Case& c, double turn, double tolerance) {
  SurveyHead& head = c.table.head;
  if (head.azimuth.north == North::kUnknown) {
    if (std::abs(turn) <= tolerance) return c.agreeing.emplace_back("north and east"), void();
    c.Note(fmt::format("north and east are turned by {} deg against the azimuths", Degrees(turn)));
    return;
  }
  const std::vector<North> fitting = NorthsThatFit(c, turn, tolerance);
  const bool as_said = std::find(fitting.begin(), fitting.end(), head.offsets) != fitting.end();
  if (as_said) return c.agreeing.emplace_back("north and east"), void();
  if (!c.claims.offsets_north && fitting.size() == 1) {
    head.offsets = fitting.front();
    c.Note(fmt::format("north and east count from {} north, azimuths from {} north",
                       WordOf(head.offsets), WordOf(head.azimuth.north)));
    return c.agreeing.emplace_back("north and east"), void();
  }
  c.Refuse(fmt::format(
      "north and east are turned by {} deg against the azimuths, which no convergence or "
      "declination of the file explains: say --azimuth-reference, --convergence-deg or "
      "--declination-deg",
      Degrees(turn)));
}

void NoteOrigin(Case& c) {
  const auto row = FirstWith(c.table, Column::kNorth);
  if (!row || std::abs(c.table.md(*row)) > kSame) return;
  const double north = *c.table.Get(Column::kNorth, *row);
  const double east = c.table.Get(Column::kEast, *row).value_or(0);
  if (std::hypot(north, east) < kSame) return;
  c.Note(
      fmt::format("north and east are {:.2f} m and {:.2f} m where MD is 0: they count from "
                  "another point than the well head",
                  north, east));
}

}  // namespace

void CheckVertical(Case& c) {
  TurnHeights(c);
  CheckDatum(c);
  CheckElevation(c);
  CheckOtherDepths(c);
  const LineFit fit = FitVertical(c.table, c.stretches, Column::kTvd);
  if (Tells(fit)) return c.agreeing.emplace_back("TVD"), void();
  // As with offsets: where there is enough of it, and no rate that most of it shares.
  if (fit.reach > kEnough && fit.sigma >= 0.05) {
    c.Refuse(
        "TVD does not follow from measured depth and inclination: name the columns by --columns, "
        "or leave it out by --columns TVD=0");
  }
}

void CheckPlane(Case& c) {
  MoveMapCoordinates(c);
  // The map first: it tells the north of the azimuths.
  for (const Plane& plane : {kPlanes[1], kPlanes[0]}) {
    PlaneFit fit = FitPlane(c.table, c.stretches, plane.north, plane.east);
    if (!Tells(fit) && !MirrorTells(fit)) {
      if (fit.reach > kEnough) DoesNotFollow(c, plane);
      continue;
    }
    const auto row = FirstWith(c.table, plane.east);
    double reach = 0;
    for (const Stretch& s : c.stretches) {
      const auto east = c.table.Get(plane.east, s.end);
      if (east) reach = std::max(reach, std::abs(*east - *c.table.Get(plane.east, *row)));
    }
    // The meridians of a well's two ends part by as much at middling latitudes.
    const double tolerance =
        4 * fit.sigma / std::abs(fit.z) + FromDegrees(0.02) + FromDegrees(0.02) * reach / 1000;
    CheckAxes(c, plane, fit, tolerance);
    if (!Tells(fit)) DoesNotFollow(c, plane);
    const double turn = std::arg(fit.z);
    plane.map ? CheckMapNorth(c, turn, tolerance) : CheckOffsetNorth(c, turn, tolerance);
  }
  NoteOrigin(c);
}

}  // namespace wellgyro::witness
