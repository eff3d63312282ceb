// Leg by leg a file may agree and yet part from its angles along the whole of the path.
#include <array>
#include <cmath>
#include <complex>
#include <string_view>

#include <fmt/core.h>

#include "wellgyro/io/exchange/columns_internal.h"
#include "wellgyro/io/exchange/witness_case_internal.h"

namespace wellgyro::witness {
namespace {

using Complex = std::complex<double>;

struct Apart {
  double by = 0, md = 0, excess = 0;  // [m]
  std::string_view what;
};

// What the path's length excuses: rounded angles, map scale, meridians that converge. Angles that
// are wrong by 0.03 deg from top to bottom make as much; of angles rounded to 0.1 deg a hundred
// legs of 30 m make a tenth of it.
double Excused(double length) { return 0.1 + 5e-4 * std::abs(length); }

// `given` and `computed` say where the path stands at a row and how far a stretch moves it.
template <class Given, class Computed>
void Follow(const Case& c, std::string_view what, Given given, Computed computed, Apart& worst) {
  Complex first = 0, at = 0;
  std::optional<std::size_t> begin;
  for (const Stretch& s : c.stretches) {
    if (!begin) {
      const std::optional<Complex> start = given(s.begin);
      if (!start) continue;
      first = *start, at = 0, begin = s.begin;
    }
    at += computed(s);
    const std::optional<Complex> place = given(s.end);
    if (!place) continue;
    const double by = std::abs(*place - first - at);
    const double excess = by - Excused(c.table.md(s.end) - c.table.md(*begin));
    if (excess > worst.excess) worst = {by, c.table.md(s.end), excess, what};
  }
}

}  // namespace

void CheckWhole(Case& c) {
  const SurveyTable& t = c.table;
  Apart worst;
  for (const Column column : {Column::kTvd, Column::kDown}) {
    if (!t.Has(column)) continue;
    Follow(
        c, InfoOf(column).text,
        [&](std::size_t row) { return std::optional<Complex>(t.Get(column, row)); },
        [](const Stretch& s) { return Complex(s.moved_W.z()); }, worst);
  }
  struct Plane {
    Column north, east;
    std::string_view text;
    bool map;
  };
  for (const Plane& p :
       {Plane{Column::kNorth, Column::kEast, "north and east", false},
        Plane{Column::kNorthing, Column::kEasting, "northing and easting", true}}) {
    const PlaneFit fit = FitPlane(t, c.stretches, p.north, p.east);
    if (!Tells(fit)) continue;
    const Complex turn = p.map ? fit.z : fit.z / std::abs(fit.z);
    const auto given = [&](std::size_t row) -> std::optional<Complex> {
      const auto n = t.Get(p.north, row), e = t.Get(p.east, row);
      if (!n || !e) return std::nullopt;
      return Complex(*n, *e);
    };
    const auto computed = [&](const Stretch& s) {
      return turn * Complex(s.moved_W.x(), s.moved_W.y());
    };
    Follow(c, p.text, given, computed, worst);
  }
  if (worst.excess <= 0) return;
  c.Note(fmt::format(
      "{} part by up to {:.2f} m, at MD {:.2f} m, from what measured depth, inclination and "
      "azimuth "
      "come to along the path: the positions were not computed from these angles, or one of both "
      "is not what its heading says; --as-listed sums positions from the angles",
      worst.what, worst.by, worst.md));
}

}  // namespace wellgyro::witness
